using System;

namespace Mocapd
{
    /// <summary>A rotation as a unit quaternion, as UnityEngine.Quaternion has it.</summary>
    public readonly struct Quat
    {
        public static readonly Quat Identity = new Quat(0f, 0f, 0f, 1f);

        public readonly float X;
        public readonly float Y;
        public readonly float Z;
        public readonly float W;

        public Quat(float x, float y, float z, float w)
        {
            X = x;
            Y = y;
            Z = z;
            W = w;
        }

        /// <summary>The rotation that takes it back.</summary>
        public Quat Inverse => new Quat(-X, -Y, -Z, W);

        /// <summary>Of length 1; only for what is nearly so.</summary>
        public Quat Normalized
        {
            get
            {
                float size = (float)Math.Sqrt((X * X) + (Y * Y) + (Z * Z) + (W * W));
                return new Quat(X / size, Y / size, Z / size, W / size);
            }
        }

        /// <summary>The vector, turned by the rotation.</summary>
        public static Vec3 operator *(Quat turn, Vec3 v)
        {
            Vec3 axis = new Vec3(turn.X, turn.Y, turn.Z);
            Vec3 twice = Vec3.Cross(axis, v) * 2f;
            return v + (twice * turn.W) + Vec3.Cross(axis, twice);
        }
    }
}
