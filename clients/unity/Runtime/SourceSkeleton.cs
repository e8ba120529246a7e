using System;
using UnityEngine;

namespace Mocapd
{
    /// <summary>
    /// The person as a humanoid of empty objects with their own bone lengths, from which Unity retargets. Its root stays at
    /// the origin of the world, which is the origin of mocapd's.
    /// </summary>
    public sealed class SourceSkeleton : IDisposable
    {
        // Unity's own defaults for a humanoid
        private const float Twist = 0.5f;
        private const float Stretch = 0.05f;

        private readonly GameObject _root;
        private readonly Transform[] _bones = new Transform[Bones.Count];
        private readonly Avatar _avatar;
        private readonly HumanPoseHandler _handler;

        /// <summary>Throws InvalidOperationException where Unity makes no humanoid of these bones.</summary>
        public SourceSkeleton(RestPose rest, string name)
        {
            Rest = rest;
            _root = new GameObject(name);
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                int parent = Bones.ParentOf(bone);
                _bones[bone] = new GameObject(Bones.UnityName(bone)).transform;
                _bones[bone].SetParent(parent == Bones.NoParent ? _root.transform : _bones[parent], false);
                _bones[bone].localPosition = rest.OffsetOf((Bone)bone).ToVector3();
            }
            _avatar = AvatarBuilder.BuildHumanAvatar(_root, Description());
            if (!_avatar.isValid || !_avatar.isHuman)
            {
                Destroy(_avatar);
                Destroy(_root);
                throw new InvalidOperationException("mocapd: Unity makes no humanoid of the person's bones");
            }
            _handler = new HumanPoseHandler(_avatar, _root.transform);
        }

        public RestPose Rest { get; }

        /// <summary>The object of a bone, for what shall hang on the person's own skeleton.</summary>
        public Transform this[Bone bone] => _bones[(int)bone];

        /// <summary>Stands as the person does in the frame; a bone that is not known keeps its place.</summary>
        public void Pose(Frame frame)
        {
            if (frame.Has(Bone.Hips))
            {
                _bones[(int)Bone.Hips].localPosition = frame[Bone.Hips].Position.ToVector3();
            }
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                if (frame.Has((Bone)bone))
                {
                    _bones[bone].localRotation = frame[(Bone)bone].LocalRotation.ToQuaternion();
                }
            }
        }

        /// <summary>The pose as every humanoid can take it.</summary>
        public void Read(ref HumanPose pose)
        {
            _handler.GetHumanPose(ref pose);
        }

        public void Dispose()
        {
            _handler.Dispose();
            Destroy(_avatar);
            Destroy(_root);
        }

        private HumanDescription Description()
        {
            HumanBone[] human = new HumanBone[Bones.Count];
            SkeletonBone[] skeleton = new SkeletonBone[Bones.Count + 1];
            skeleton[0] = AtRest(_root.transform);
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                human[bone] = new HumanBone
                {
                    boneName = _bones[bone].name,
                    humanName = Bones.UnityName(bone),
                    limit = new HumanLimit { useDefaultValues = true },
                };
                skeleton[bone + 1] = AtRest(_bones[bone]);
            }
            return new HumanDescription
            {
                human = human,
                skeleton = skeleton,
                upperArmTwist = Twist,
                lowerArmTwist = Twist,
                upperLegTwist = Twist,
                lowerLegTwist = Twist,
                armStretch = Stretch,
                legStretch = Stretch,
            };
        }

        private static SkeletonBone AtRest(Transform bone) => new SkeletonBone
        {
            name = bone.name,
            position = bone.localPosition,
            rotation = Quaternion.identity,
            scale = Vector3.one,
        };

        private static void Destroy(UnityEngine.Object thing)
        {
            if (Application.isPlaying)
            {
                UnityEngine.Object.Destroy(thing);
            }
            else
            {
                UnityEngine.Object.DestroyImmediate(thing);
            }
        }
    }
}
