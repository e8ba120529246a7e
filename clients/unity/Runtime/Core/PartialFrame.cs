using System;
using System.Collections.Generic;

namespace Mocapd
{
    /// <summary>A frame of which parts may be missing yet, and what the wire says of it.</summary>
    internal sealed class PartialFrame
    {
        private const int MaxParts = 64;
        private const int MaxJoints = 256;
        private const float FarMetres = 1000f; // no joint is as far from the origin
        private const float UnitTolerance = 0.01f; // of the square of a quaternion's length

        private readonly HashSet<string> _joints = new HashSet<string>(); // also those that were refused
        private int _jointCount;
        private int _parts;
        private ulong _heard; // a bit for each part

        public readonly Frame Frame = new Frame();

        /// <summary>Which part it was begun with.</summary>
        public int Part { get; private set; }

        public bool HasAllParts => _heard == (_parts == MaxParts ? ulong.MaxValue : (1UL << _parts) - 1);

        public bool HasAllJoints => _joints.Count == _jointCount;

        /// <summary>From the message before the joints; null where a number or a word of it cannot be.</summary>
        public static PartialFrame Begun(OscMessage head)
        {
            List<int> ints = head.Ints; // person seq part parts joints capture_s capture_ns
            Tracking tracking = TrackingOf(head.Strings[0]);
            float latency = head.Floats[0];
            bool isPossible = ints[0] >= 0 && ints[0] < FrameCollector.MaxPersons && ints[1] >= 0
                && ints[3] > 0 && ints[3] <= MaxParts && ints[2] >= 0 && ints[2] < ints[3]
                && ints[4] >= 0 && ints[4] <= MaxJoints && ints[6] >= 0 && ints[6] < 1000000000
                && IsFinite(latency) && tracking != Tracking.Silent;
            if (!isPossible)
            {
                return null;
            }
            PartialFrame part = new PartialFrame { Part = ints[2], _parts = ints[3], _jointCount = ints[4] };
            part.Frame.Person = ints[0];
            part.Frame.Seq = ints[1];
            part.Frame.CaptureUnixNs = (unchecked((uint)ints[5]) * 1000000000L) + ints[6]; // the seconds are unsigned
            part.Frame.LatencySeconds = latency;
            part.Frame.Tracking = tracking;
            part.Frame.Tracker = head.Strings[1];
            part.Frame.Cameras = head.Strings[2];
            part.Frame.Instance = head.Strings[3];
            return part;
        }

        public bool HasSameTimeAs(PartialFrame other) =>
            Frame.Seq == other.Frame.Seq && Frame.CaptureUnixNs == other.Frame.CaptureUnixNs;

        public bool IsSameAs(PartialFrame other) =>
            HasSameTimeAs(other) && _parts == other._parts && _jointCount == other._jointCount;

        public void Heard(int part)
        {
            _heard |= 1UL << part;
        }

        /// <summary>A joint of the frame; one that cannot be is left out, and counted.</summary>
        public void Add(OscMessage message, Trouble trouble)
        {
            if (!message.Address.StartsWith(OscReader.JointAddress, StringComparison.Ordinal))
            {
                return;
            }
            string name = message.Address.Substring(OscReader.JointAddress.Length);
            List<float> n = message.Floats; // px py pz, rx ry rz rw, lx ly lz lw, c
            _joints.Add(name);
            if (!IsJoint(n))
            {
                trouble.Add(TroubleKind.Number, name);
                return;
            }
            int bone = Bones.OfVrmName(name);
            if (bone >= 0) // else one that is newer than this package
            {
                Frame.Set(bone, new JointPose(
                    UnityAxes.Position(n[0], n[1], n[2]),
                    UnityAxes.Rotation(n[3], n[4], n[5], n[6]),
                    UnityAxes.Rotation(n[7], n[8], n[9], n[10]),
                    n[11]));
            }
        }

        private static Tracking TrackingOf(string word)
        {
            switch (word)
            {
                case "live":
                    return Tracking.Live;
                case "coasting":
                    return Tracking.Coasting;
                case "lost":
                    return Tracking.Lost;
                default:
                    return Tracking.Silent;
            }
        }

        private static bool IsJoint(List<float> n)
        {
            foreach (float number in n)
            {
                if (!IsFinite(number))
                {
                    return false;
                }
            }
            return Math.Abs(n[0]) <= FarMetres && Math.Abs(n[1]) <= FarMetres && Math.Abs(n[2]) <= FarMetres
                && IsTurn(n, 3) && IsTurn(n, 7);
        }

        // Whether the four numbers are nearly a unit quaternion.
        private static bool IsTurn(List<float> n, int at)
        {
            float square = (n[at] * n[at]) + (n[at + 1] * n[at + 1]) + (n[at + 2] * n[at + 2]) + (n[at + 3] * n[at + 3]);
            return Math.Abs(square - 1f) < UnitTolerance;
        }

        private static bool IsFinite(float number) => !float.IsNaN(number) && !float.IsInfinity(number);
    }
}
