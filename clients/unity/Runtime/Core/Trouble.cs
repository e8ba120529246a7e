using System.Text;

namespace Mocapd
{
    /// <summary>What can be wrong with what comes.</summary>
    public enum TroubleKind
    {
        NotOsc,
        CutOff,
        Foreign,
        Newer,
        Types,
        Number,
        InPart,
        SecondSender,
    }

    /// <summary>How often each kind of trouble came, and what the last one was about.</summary>
    public sealed class Trouble
    {
        private static readonly string[] _words =
        {
            "what is no OSC",
            "datagrams that are cut off",
            "messages of another program",
            "a newer schema than v1, which needs a newer version of this package",
            "arguments of the wrong types",
            "numbers that cannot be",
            "frames of which a part is missing",
            "a second daemon, which is not listened to",
        };

        private readonly int[] _counts = new int[_words.Length];
        private readonly string[] _about = new string[_words.Length];

        /// <summary>How many kinds have come.</summary>
        public int Kinds { get; private set; }

        public int Count(TroubleKind kind) => _counts[(int)kind];

        public void Add(TroubleKind kind, string about)
        {
            if (_counts[(int)kind] == 0)
            {
                Kinds++;
            }
            _counts[(int)kind]++;
            _about[(int)kind] = about;
        }

        /// <summary>One line for people; empty without trouble.</summary>
        public override string ToString()
        {
            StringBuilder line = new StringBuilder();
            for (int kind = 0; kind < _words.Length; kind++)
            {
                if (_counts[kind] == 0)
                {
                    continue;
                }
                line.Append(line.Length > 0 ? "; " : string.Empty).Append(_counts[kind]).Append(" x ").Append(_words[kind]);
                if (_about[kind].Length > 0)
                {
                    line.Append(" (").Append(_about[kind]).Append(')');
                }
            }
            return line.ToString();
        }
    }
}
