namespace Mocapd
{
    /// <summary>
    /// From mocapd's world (right-handed, +Y up) to Unity's (left-handed, +Y up): x is turned round, so that a person at
    /// rest faces +Z in both, with the left hand at Unity's -X. Source: docs/wire.md of mocapd.
    /// </summary>
    public static class UnityAxes
    {
        public static Vec3 Position(float x, float y, float z) => new Vec3(-x, y, z);

        public static Quat Rotation(float x, float y, float z, float w) => new Quat(x, -y, -z, w).Normalized;
    }
}
