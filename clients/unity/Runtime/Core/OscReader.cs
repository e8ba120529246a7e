using System;
using System.Collections.Generic;
using System.Text;

namespace Mocapd
{
    /// <summary>A message of ours: its address, and the arguments that are known of it, in order.</summary>
    internal sealed class OscMessage
    {
        public string Address;
        public readonly List<int> Ints = new List<int>();
        public readonly List<float> Floats = new List<float>();
        public readonly List<string> Strings = new List<string>();
    }

    /// <summary>
    /// Datagrams of OSC 1.0 to messages, as far as mocapd sends them: bundles of messages of i, f and s. Nothing is believed:
    /// every length is checked before it is used, and a datagram that is cut off is refused as a whole.
    /// </summary>
    internal sealed class OscReader
    {
        public const string FrameAddress = "/mocapd/v1/frame";
        public const string JointAddress = "/mocapd/v1/joint/";
        private const string Ours = "/mocapd/";
        private const string V1 = "/mocapd/v1/";
        private const string FrameTypes = ",iiiiiiifssss";
        private const string JointTypes = ",ffffffffffff";
        private const int BundleHeaderBytes = 16; // "#bundle", NUL, and the time tag
        private const int MaxAddressBytes = 128;
        private const int MaxStringBytes = 1024;

        private readonly Trouble _trouble;
        private byte[] _bytes;

        public OscReader(Trouble trouble)
        {
            _trouble = trouble;
        }

        /// <summary>The messages of a datagram, in order; what is wrong is counted.</summary>
        public List<OscMessage> Read(byte[] datagram, int size)
        {
            List<OscMessage> messages = new List<OscMessage>();
            _bytes = datagram;
            if (size < 4 || size % 4 != 0)
            {
                _trouble.Add(TroubleKind.NotOsc, string.Empty);
            }
            else if (datagram[0] == (byte)'/')
            {
                ReadMessage(0, size, messages);
            }
            else if (size >= BundleHeaderBytes && Text(0, size) == "#bundle")
            {
                ReadBundle(size, messages);
            }
            else
            {
                _trouble.Add(TroubleKind.NotOsc, string.Empty);
            }
            return messages;
        }

        private void ReadBundle(int size, List<OscMessage> messages)
        {
            for (int at = BundleHeaderBytes; at < size; at += 4 + Int(at))
            {
                int length = Int(at); // a size of a multiple of 4 leaves room for it
                if (length <= 0 || length % 4 != 0 || length > size - at - 4)
                {
                    _trouble.Add(TroubleKind.CutOff, string.Empty);
                    return;
                }
            }
            for (int at = BundleHeaderBytes; at < size; at += 4 + Int(at))
            {
                ReadMessage(at + 4, at + 4 + Int(at), messages);
            }
        }

        private void ReadMessage(int at, int end, List<OscMessage> messages)
        {
            string address = Text(at, end);
            if (address.Length < 2 || address.Length > MaxAddressBytes || address[0] != '/')
            {
                _trouble.Add(TroubleKind.NotOsc, string.Empty);
                return;
            }
            int typesAt = Behind(at, address.Length);
            string types = Text(typesAt, end);
            if (types.Length == 0 || types[0] != ',')
            {
                _trouble.Add(TroubleKind.NotOsc, address);
            }
            else if (address == FrameAddress)
            {
                ReadArguments(address, FrameTypes, types, typesAt, end, messages);
            }
            else if (address.StartsWith(JointAddress, StringComparison.Ordinal))
            {
                ReadArguments(address, JointTypes, types, typesAt, end, messages);
            }
            else if (!address.StartsWith(Ours, StringComparison.Ordinal))
            {
                _trouble.Add(TroubleKind.Foreign, address);
            }
            else if (!address.StartsWith(V1, StringComparison.Ordinal))
            {
                _trouble.Add(TroubleKind.Newer, address);
            }
            // what else v1 may send one day is none of ours
        }

        // Within v1 arguments are only added, at the end: what follows those that are known is not looked at.
        private void ReadArguments(
            string address, string known, string types, int typesAt, int end, List<OscMessage> messages)
        {
            if (!types.StartsWith(known, StringComparison.Ordinal))
            {
                _trouble.Add(TroubleKind.Types, address);
                return;
            }
            OscMessage message = new OscMessage { Address = address };
            int at = Behind(typesAt, types.Length);
            for (int place = 1; place < known.Length; place++)
            {
                int length = known[place] == 's' ? Length(at, end) : 4;
                if (length < 0 || length > MaxStringBytes || at + length > end)
                {
                    _trouble.Add(TroubleKind.CutOff, address);
                    return;
                }
                switch (known[place])
                {
                    case 'i':
                        message.Ints.Add(Int(at));
                        at += length;
                        break;
                    case 'f':
                        message.Floats.Add(Float(at));
                        at += length;
                        break;
                    default:
                        message.Strings.Add(Encoding.UTF8.GetString(_bytes, at, length));
                        at = Behind(at, length);
                        break;
                }
            }
            messages.Add(message);
        }

        // How many bytes are before the next NUL; -1 where there is none before the end.
        private int Length(int at, int end)
        {
            for (int place = at; place < end; place++)
            {
                if (_bytes[place] == 0)
                {
                    return place - at;
                }
            }
            return -1;
        }

        // Of plain ASCII, as addresses and type tags are; empty where it is none.
        private string Text(int at, int end)
        {
            int length = Length(at, end);
            for (int place = at; place < at + length; place++)
            {
                if (_bytes[place] < 0x21 || _bytes[place] > 0x7E)
                {
                    return string.Empty;
                }
            }
            return length > 0 ? Encoding.ASCII.GetString(_bytes, at, length) : string.Empty;
        }

        // Where the next thing begins behind a string of so many bytes: it ends with a NUL, padded to 4.
        private static int Behind(int at, int length) => at + length + 4 - (length % 4);

        private int Int(int at) => (_bytes[at] << 24) | (_bytes[at + 1] << 16) | (_bytes[at + 2] << 8) | _bytes[at + 3];

        // Whatever the processor's order of bytes is.
        private float Float(int at) => BitConverter.ToSingle(BitConverter.GetBytes(Int(at)), 0);
    }
}
