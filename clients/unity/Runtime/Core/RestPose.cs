using System;

namespace Mocapd
{
    /// <summary>
    /// The person's T-pose, in which all rotations are the identity: of each bone its place relative to the bone above, in
    /// Unity's axes [m]. It need not be sent, as every frame has it: turned back by the rotation of the bone above, the way
    /// between two joints is the offset in the T-pose.
    /// </summary>
    public sealed class RestPose
    {
        // How high the lowest joint, a toe, is above the floor, by its way below the hips; mocapd's mean proportions
        private const float ToesAboveFloor = 0.0368f;

        private readonly Vec3[] _offsets = new Vec3[Bones.Count];

        private RestPose()
        {
        }

        /// <summary>Of the hips: from the floor below, which no frame says, so by mean proportions.</summary>
        public Vec3 OffsetOf(Bone bone) => _offsets[(int)bone];

        /// <summary>From a frame; null where a bone of it is not known.</summary>
        public static RestPose Of(Frame frame)
        {
            RestPose rest = new RestPose();
            Vec3[] places = new Vec3[Bones.Count]; // in the T-pose, from the hips
            float lowest = 0f;
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                if (!frame.Has((Bone)bone))
                {
                    return null;
                }
                int parent = Bones.ParentOf(bone);
                if (parent == Bones.NoParent)
                {
                    continue;
                }
                JointPose above = frame[(Bone)parent];
                rest._offsets[bone] = above.Rotation.Inverse * (frame[(Bone)bone].Position - above.Position);
                places[bone] = places[parent] + rest._offsets[bone];
                lowest = Math.Min(lowest, places[bone].Y);
            }
            rest._offsets[(int)Bone.Hips] = new Vec3(0f, -lowest * (1f + ToesAboveFloor), 0f);
            return rest;
        }

        /// <summary>By how much the bone differs most that differs most [m].</summary>
        public float DifferenceFrom(RestPose other)
        {
            float most = 0f;
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                most = Math.Max(most, (_offsets[bone] - other._offsets[bone]).Length);
            }
            return most;
        }
    }
}
