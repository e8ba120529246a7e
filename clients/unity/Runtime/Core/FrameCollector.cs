using System;
using System.Collections.Generic;
using System.Globalization;

namespace Mocapd
{
    /// <summary>
    /// Datagrams to whole frames: of each person the newest one, and whether it still holds. A frame comes as one datagram or
    /// several (docs/wire.md of mocapd); parts of different frames are never mixed. For one thread.
    /// </summary>
    public sealed class FrameCollector
    {
        public const int MaxPersons = 16;
        private const int MaxCollected = 64; // frames begun and not whole, of all persons and senders
        private const double LostSeconds = 3.0; // "lost" is said once a second

        private readonly OscReader _reader;
        private readonly Frame[] _newest = new Frame[MaxPersons];
        private readonly Dictionary<string, PartialFrame> _begun = new Dictionary<string, PartialFrame>();

        public FrameCollector()
        {
            _reader = new OscReader(Trouble);
        }

        /// <summary>After so long without a frame nothing is known: a live daemon sends ten a second and more [s].</summary>
        public double SilenceSeconds { get; set; } = 0.5;

        public Trouble Trouble { get; } = new Trouble();

        /// <summary>
        /// Takes a datagram that came at a time of the caller's clock [s]. The person whose newest frame it made whole, or -1.
        /// </summary>
        public int Take(byte[] datagram, int size, double nowSeconds)
        {
            Frame frame = Whole(_reader.Read(datagram, size), nowSeconds);
            if (frame == null)
            {
                return -1;
            }
            frame.HeardSeconds = nowSeconds;
            frame.Finish();
            _newest[frame.Person] = frame;
            return frame.Person;
        }

        /// <summary>The newest whole frame of a person; null where there is none yet.</summary>
        public Frame NewestOf(int person) => person >= 0 && person < MaxPersons ? _newest[person] : null;

        public Tracking TrackingOf(int person, double nowSeconds)
        {
            Frame newest = NewestOf(person);
            if (newest == null)
            {
                return Tracking.Silent;
            }
            double holds = newest.Tracking == Tracking.Lost ? Math.Max(SilenceSeconds, LostSeconds) : SilenceSeconds;
            return nowSeconds - newest.HeardSeconds <= holds ? newest.Tracking : Tracking.Silent;
        }

        /// <summary>One line for people: who is tracked by whom, or why nobody is, and what was wrong with what came.</summary>
        public string Status(int person, double nowSeconds)
        {
            string words = State(person, nowSeconds);
            return Trouble.Kinds > 0 ? words + "; " + Trouble : words;
        }

        private string State(int person, double nowSeconds)
        {
            Frame newest = NewestOf(person);
            if (newest == null)
            {
                return "nothing heard of person " + person + " yet: is mocapd running, and sending OSC here?";
            }
            Tracking tracking = TrackingOf(person, nowSeconds);
            switch (tracking)
            {
                case Tracking.Silent:
                    string since = (nowSeconds - newest.HeardSeconds).ToString("0.0", CultureInfo.InvariantCulture);
                    return "silent for " + since + " s: " + newest.Instance + " has stopped";
                case Tracking.Lost:
                    return "lost: " + newest.Instance + " sees nobody";
                default:
                    string kind = tracking == Tracking.Live ? "live: " : "coasting: ";
                    int ageMs = (int)(newest.LatencySeconds * 1000f);
                    return kind + newest.Instance + " by " + newest.Tracker + ", " + ageMs + " ms old when sent";
            }
        }

        // The frame that these messages of a datagram make whole; null where they do not.
        private Frame Whole(List<OscMessage> messages, double nowSeconds)
        {
            PartialFrame part = Opened(messages);
            if (part == null || !IsWanted(part.Frame, nowSeconds))
            {
                return null;
            }
            string key = part.Frame.Person + " " + part.Frame.Instance;
            PartialFrame collected = Collected(key, part, nowSeconds);
            if (collected == null)
            {
                return null;
            }
            for (int place = 1; place < messages.Count; place++)
            {
                collected.Add(messages[place], Trouble);
            }
            collected.Heard(part.Part);
            if (!collected.HasAllParts)
            {
                return null;
            }
            _begun.Remove(key);
            if (!collected.HasAllJoints)
            {
                Trouble.Add(TroubleKind.InPart, "frame " + collected.Frame.Seq);
                return null;
            }
            return collected.Frame;
        }

        // The frame that a datagram begins with, without its joints; null where it does not, or where it cannot be.
        private PartialFrame Opened(List<OscMessage> messages)
        {
            if (messages.Count == 0)
            {
                return null;
            }
            if (messages[0].Address != OscReader.FrameAddress)
            {
                Trouble.Add(TroubleKind.InPart, messages[0].Address);
                return null;
            }
            PartialFrame part = PartialFrame.Begun(messages[0]);
            if (part == null)
            {
                Trouble.Add(TroubleKind.Number, OscReader.FrameAddress);
            }
            return part;
        }

        // While frames come, only later ones of the same daemon are.
        private bool IsWanted(Frame frame, double nowSeconds)
        {
            if (TrackingOf(frame.Person, nowSeconds) == Tracking.Silent)
            {
                return true;
            }
            Frame before = _newest[frame.Person];
            if (before.Instance != frame.Instance)
            {
                Trouble.Add(TroubleKind.SecondSender, frame.Instance);
                return false;
            }
            return IsNewer(frame, before);
        }

        // The frame that this part belongs to, begun now or before; null where a newer one was begun a moment ago.
        private PartialFrame Collected(string key, PartialFrame part, double nowSeconds)
        {
            if (_begun.TryGetValue(key, out PartialFrame before))
            {
                if (before.IsSameAs(part))
                {
                    return before;
                }
                bool isRecent = nowSeconds - before.Frame.HeardSeconds <= SilenceSeconds;
                if (isRecent && !before.HasSameTimeAs(part) && !IsNewer(part.Frame, before.Frame))
                {
                    return null;
                }
                Trouble.Add(TroubleKind.InPart, "frame " + before.Frame.Seq);
            }
            else if (_begun.Count >= MaxCollected)
            {
                _begun.Clear();
            }
            part.Frame.HeardSeconds = nowSeconds;
            _begun[key] = part;
            return part;
        }

        // By its number or by its time: a daemon that was started anew counts from 0, a recording goes back in time.
        private static bool IsNewer(Frame frame, Frame before)
        {
            int ahead = unchecked(frame.Seq - before.Seq) & 0x7FFFFFFF; // counted modulo 2^31
            return (ahead > 0 && ahead < 0x40000000) || frame.CaptureUnixNs > before.CaptureUnixNs;
        }
    }
}
