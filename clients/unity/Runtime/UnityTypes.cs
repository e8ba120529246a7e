using UnityEngine;

namespace Mocapd
{
    /// <summary>The same numbers as Unity's types.</summary>
    public static class UnityTypes
    {
        public static Vector3 ToVector3(this Vec3 v) => new Vector3(v.X, v.Y, v.Z);

        public static Quaternion ToQuaternion(this Quat q) => new Quaternion(q.X, q.Y, q.Z, q.W);
    }
}
