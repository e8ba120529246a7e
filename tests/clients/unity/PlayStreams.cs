// Plays streams to the Unity package and prints what it makes of them, as JSON.
//
// usage: mono PlayStreams.exe STREAMS PORT
//   STREAMS  a file of lines: "stream NAME", then its steps: "TIME HEXADECIMAL", or "TIME -" where nothing came
//   PORT     of three free UDP ports the first
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Net;
using System.Net.Sockets;
using System.Threading;
using UnityEngine;

namespace Mocapd.Tests
{
    public static class PlayStreams
    {
        private const int Patience = 24000; // looks, of 5 ms each
        private const double Patient = 600.0; // no machine is so slow that a stream seems silent [s]

        public static void Main(string[] arguments)
        {
            int port = int.Parse(arguments[1], CultureInfo.InvariantCulture);
            List<byte[]> golden = new List<byte[]>();
            byte[] lost = null;
            List<string> told = new List<string>();
            foreach (KeyValuePair<string, List<string>> stream in Streams(arguments[0]))
            {
                told.Add(Json(stream.Key) + ":" + Played(stream.Value));
                IEnumerable<byte[]> packets = stream.Value.Select(Datagram).Where(one => one != null);
                if (stream.Key == "golden")
                {
                    golden.AddRange(packets);
                }
                else if (stream.Key == "lost first")
                {
                    lost = packets.Last();
                }
            }
            told.Add("\"over UDP\":" + PlayedOverUdp(golden, port));
            told.Add("\"scene\":" + Scene.Played(golden, lost, port + 1));
            told.Add("\"sample\":" + Scene.PlayedSample(golden, port + 2));
            Console.WriteLine("{" + string.Join(",", told) + "}");
        }

        public static string Json(string text) => "\"" + text.Replace("\\", "\\\\").Replace("\"", "\\\"") + "\"";

        public static string Json(bool value) => value ? "true" : "false";

        public static string Json(float x, float y, float z) => "[" + Json(x) + "," + Json(y) + "," + Json(z) + "]";

        public static string Json(float value) => value.ToString("R", CultureInfo.InvariantCulture);

        public static bool Eventually(Func<bool> holds)
        {
            for (int look = 0; look < Patience && !holds(); look++)
            {
                Thread.Sleep(5);
            }
            return holds();
        }

        public static void Send(IEnumerable<byte[]> packets, int port)
        {
            using (UdpClient sender = new UdpClient())
            {
                foreach (byte[] packet in packets)
                {
                    sender.Send(packet, packet.Length, "127.0.0.1", port);
                }
            }
        }

        private static Dictionary<string, List<string>> Streams(string path)
        {
            Dictionary<string, List<string>> streams = new Dictionary<string, List<string>>();
            List<string> steps = null;
            foreach (string line in File.ReadAllLines(path))
            {
                if (line.StartsWith("stream ", StringComparison.Ordinal))
                {
                    streams[line.Substring("stream ".Length)] = steps = new List<string>();
                }
                else
                {
                    steps.Add(line);
                }
            }
            return streams;
        }

        private static double Time(string step) => double.Parse(step.Split(' ')[0], CultureInfo.InvariantCulture);

        private static byte[] Datagram(string step)
        {
            string hex = step.Split(' ')[1];
            if (hex == "-")
            {
                return null;
            }
            byte[] datagram = new byte[hex.Length / 2];
            for (int place = 0; place < datagram.Length; place++)
            {
                datagram[place] = Convert.ToByte(hex.Substring(2 * place, 2), 16);
            }
            return datagram;
        }

        private static string Played(List<string> stream)
        {
            FrameCollector collector = new FrameCollector();
            List<string> steps = new List<string>();
            foreach (string step in stream)
            {
                byte[] datagram = Datagram(step);
                int person = datagram == null ? -1 : collector.Take(datagram, datagram.Length, Time(step));
                steps.Add("[" + person + "," + Word(collector.TrackingOf(0, Time(step))) + "]");
            }
            string status = collector.Status(0, Time(stream.Last()));
            return Result(steps, collector.Trouble, status, person => collector.NewestOf(person));
        }

        private static string PlayedOverUdp(List<byte[]> golden, int port)
        {
            using (FrameReceiver receiver = new FrameReceiver(port, IPAddress.Loopback, Patient))
            {
                bool isRefused = false;
                try
                {
                    new FrameReceiver(port, IPAddress.Loopback, Patient).Dispose();
                }
                catch (SocketException)
                {
                    isRefused = true;
                }
                Send(golden, port);
                bool isHeard = Eventually(() => receiver.NewestOf(0) != null);
                List<string> steps = new List<string> { "[" + (isHeard ? 0 : -1) + "," + Word(receiver.TrackingOf(0)) + "]" };
                string result = Result(steps, new Trouble(), receiver.Status(0), receiver.NewestOf);
                string more = ",\"refused\":" + Json(isRefused) + ",\"trouble_kinds\":" + receiver.TroubleKinds + "}";
                return result.Substring(0, result.Length - 1) + more;
            }
        }

        private static string Word(Tracking tracking) => Json(tracking.ToString().ToLowerInvariant());

        private static string Result(List<string> steps, Trouble trouble, string status, Func<int, Frame> newest)
        {
            string[] kinds = { "not_osc", "cut_off", "foreign", "newer", "types", "number", "in_part", "second_sender" };
            IEnumerable<string> counts = Enum.GetValues(typeof(TroubleKind)).Cast<TroubleKind>()
                .Where(kind => trouble.Count(kind) > 0)
                .Select(kind => Json(kinds[(int)kind]) + ":" + trouble.Count(kind));
            IEnumerable<string> persons = new[] { 0, 1 }.Where(person => newest(person) != null)
                .Select(person => Json(person.ToString()) + ":" + Described(newest(person)));
            return "{\"steps\":[" + string.Join(",", steps) + "],\"trouble\":{" + string.Join(",", counts)
                + "},\"status\":" + Json(status) + ",\"persons\":{" + string.Join(",", persons) + "}}";
        }

        private static string Described(Frame frame)
        {
            List<string> joints = new List<string>();
            RestPose rest = RestPose.Of(frame);
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                if (frame.Has((Bone)bone))
                {
                    joints.Add(Described(bone, frame[(Bone)bone], rest));
                }
            }
            return "{\"seq\":" + frame.Seq + ",\"capture_unix_ns\":\"" + frame.CaptureUnixNs + "\",\"instance\":"
                + Json(frame.Instance) + ",\"joints\":{" + string.Join(",", joints) + "}}";
        }

        private static string Described(int bone, JointPose joint, RestPose rest)
        {
            string name = Bones.UnityName(bone);
            Vec3 at = joint.Position;
            Vec3 offset = rest == null ? default(Vec3) : rest.OffsetOf((Bone)bone);
            return Json(char.ToLowerInvariant(name[0]) + name.Substring(1)) + ":{\"origin\":" + Json(at.X, at.Y, at.Z)
                + ",\"rotation\":" + Described(joint.Rotation) + ",\"local\":" + Described(joint.LocalRotation)
                + ",\"confidence\":" + Json(joint.Confidence) + ",\"rest\":" + Json(offset.X, offset.Y, offset.Z) + "}";
        }

        private static string Described(Quat q) => "[" + Json(q.X) + "," + Json(q.Y) + "," + Json(q.Z) + "," + Json(q.W) + "]";
    }
}
