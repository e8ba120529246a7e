namespace Mocapd
{
    /// <summary>What is known of a person at a moment.</summary>
    public enum Tracking
    {
        /// <summary>Nothing has come for a while, or never.</summary>
        Silent,

        /// <summary>There is evidence in this frame.</summary>
        Live,

        /// <summary>The pose is predicted for a moment.</summary>
        Coasting,

        /// <summary>Nobody is seen.</summary>
        Lost,
    }

    /// <summary>One bone of a frame, in Unity's axes.</summary>
    public readonly struct JointPose
    {
        /// <summary>In the world [m].</summary>
        public readonly Vec3 Position;

        /// <summary>In the world, relative to the T-pose.</summary>
        public readonly Quat Rotation;

        /// <summary>Relative to the bone above.</summary>
        public readonly Quat LocalRotation;

        /// <summary>0..1, near 0 where there is no evidence.</summary>
        public readonly float Confidence;

        public JointPose(Vec3 position, Quat rotation, Quat localRotation, float confidence)
        {
            Position = position;
            Rotation = rotation;
            LocalRotation = localRotation;
            Confidence = confidence;
        }
    }

    /// <summary>One person at one instant. Not changed any more once it is whole.</summary>
    public sealed class Frame
    {
        private readonly JointPose[] _joints = new JointPose[Bones.Count];
        private readonly bool[] _known = new bool[Bones.Count];

        /// <summary>Number of the person.</summary>
        public int Person { get; internal set; }

        /// <summary>Counts the frames, modulo 2^31.</summary>
        public int Seq { get; internal set; }

        /// <summary>Middle of the exposure, Unix time [ns].</summary>
        public long CaptureUnixNs { get; internal set; }

        /// <summary>Capture to publish [s].</summary>
        public float LatencySeconds { get; internal set; }

        public Tracking Tracking { get; internal set; }

        /// <summary>Which tracker.</summary>
        public string Tracker { get; internal set; }

        /// <summary>Cameras whose evidence was used, joined by commas.</summary>
        public string Cameras { get; internal set; }

        /// <summary>Name of the sending daemon.</summary>
        public string Instance { get; internal set; }

        /// <summary>When it was whole, by the receiver's clock [s].</summary>
        public double HeardSeconds { get; internal set; }

        /// <summary>Whether this bone and all bones above it are known.</summary>
        public bool Has(Bone bone) => _known[(int)bone];

        /// <summary>One bone; only meaningful where Has says so.</summary>
        public JointPose this[Bone bone] => _joints[(int)bone];

        internal void Set(int bone, JointPose joint)
        {
            _joints[bone] = joint;
            _known[bone] = true;
        }

        /// <summary>Leaves out what hangs on a bone that is not known, or everything.</summary>
        internal void Finish()
        {
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                int parent = Bones.ParentOf(bone);
                bool hangs = parent == Bones.NoParent || _known[parent];
                _known[bone] = _known[bone] && hangs && Tracking != Tracking.Lost;
            }
        }
    }
}
