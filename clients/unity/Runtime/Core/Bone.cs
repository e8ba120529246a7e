namespace Mocapd
{
    /// <summary>The bones that mocapd knows; every parent before its children.</summary>
    public enum Bone
    {
        Hips, Spine, Chest, UpperChest, Neck, Head,
        LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand,
        RightShoulder, RightUpperArm, RightLowerArm, RightHand,
        LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes,
        RightUpperLeg, RightLowerLeg, RightFoot, RightToes,
    }

    /// <summary>Names of the bones, and what hangs on what.</summary>
    public static class Bones
    {
        public const int Count = (int)Bone.RightToes + 1;

        /// <summary>The bone is the root.</summary>
        public const int NoParent = -1;

        private static readonly int[] _parents =
        {
            NoParent, (int)Bone.Hips, (int)Bone.Spine, (int)Bone.Chest, (int)Bone.UpperChest, (int)Bone.Neck,
            (int)Bone.UpperChest, (int)Bone.LeftShoulder, (int)Bone.LeftUpperArm, (int)Bone.LeftLowerArm,
            (int)Bone.UpperChest, (int)Bone.RightShoulder, (int)Bone.RightUpperArm, (int)Bone.RightLowerArm,
            (int)Bone.Hips, (int)Bone.LeftUpperLeg, (int)Bone.LeftLowerLeg, (int)Bone.LeftFoot,
            (int)Bone.Hips, (int)Bone.RightUpperLeg, (int)Bone.RightLowerLeg, (int)Bone.RightFoot,
        };

        /// <summary>The bone above it, or NoParent.</summary>
        public static int ParentOf(int bone) => _parents[bone];

        /// <summary>As Unity's HumanBodyBones spells it.</summary>
        public static string UnityName(int bone) => ((Bone)bone).ToString();

        /// <summary>The bone of a VRM 1.0 name, as on the wire; -1 for others.</summary>
        public static int OfVrmName(string name)
        {
            for (int bone = 0; bone < Count; bone++)
            {
                if (VrmNames[bone] == name)
                {
                    return bone;
                }
            }
            return -1;
        }

        private static readonly string[] VrmNames = MakeVrmNames();

        private static string[] MakeVrmNames()
        {
            string[] names = new string[Count];
            for (int bone = 0; bone < Count; bone++)
            {
                string name = UnityName(bone);
                names[bone] = char.ToLowerInvariant(name[0]) + name.Substring(1);
            }
            return names;
        }
    }
}
