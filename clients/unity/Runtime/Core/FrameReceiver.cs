using System;
using System.Diagnostics;
using System.Net;
using System.Net.Sockets;
using System.Threading;

namespace Mocapd
{
    /// <summary>
    /// Listens to mocapd on a thread of its own and keeps the newest frame of each person: nothing queues up, whoever asks
    /// gets the newest. May be asked from any thread.
    /// </summary>
    public sealed class FrameReceiver : IDisposable
    {
        private const int MaxDatagramBytes = 65535;
        private const int BufferBytes = 1 << 18;
        private const int WakeMilliseconds = 250; // how often it looks whether it shall end
        private const int PauseMilliseconds = 100; // after trouble with the socket itself

        private readonly object _gate = new object();
        private readonly FrameCollector _collector = new FrameCollector();
        private readonly Stopwatch _clock = Stopwatch.StartNew();
        private readonly Socket _socket;
        private readonly Thread _thread;
        private volatile bool _isClosing;

        /// <summary>
        /// Begins to listen; IPAddress.Loopback for this machine, IPAddress.Any for others too. Throws SocketException
        /// when somebody else has the port.
        /// </summary>
        public FrameReceiver(int port, IPAddress address, double silenceSeconds)
        {
            _collector.SilenceSeconds = silenceSeconds;
            _socket = new Socket(AddressFamily.InterNetwork, SocketType.Dgram, ProtocolType.Udp);
            try
            {
                _socket.ExclusiveAddressUse = true; // else Mono lets two programs have the port, and one hears nothing
                _socket.ReceiveBufferSize = BufferBytes;
                _socket.ReceiveTimeout = WakeMilliseconds;
                _socket.Bind(new IPEndPoint(address, port));
            }
            catch (SocketException)
            {
                _socket.Close();
                throw;
            }
            _thread = new Thread(Listen) { IsBackground = true, Name = "mocapd" };
            _thread.Start();
        }

        /// <summary>How many kinds of trouble there have been.</summary>
        public int TroubleKinds
        {
            get
            {
                lock (_gate)
                {
                    return _collector.Trouble.Kinds;
                }
            }
        }

        /// <summary>The newest whole frame of a person, the same again while there is no newer; null before the first.</summary>
        public Frame NewestOf(int person)
        {
            lock (_gate)
            {
                return _collector.NewestOf(person);
            }
        }

        public Tracking TrackingOf(int person)
        {
            lock (_gate)
            {
                return _collector.TrackingOf(person, _clock.Elapsed.TotalSeconds);
            }
        }

        /// <summary>One line for people: who is tracked by whom, or why nobody is, and what was wrong with what came.</summary>
        public string Status(int person)
        {
            lock (_gate)
            {
                return _collector.Status(person, _clock.Elapsed.TotalSeconds);
            }
        }

        /// <summary>Ends the thread and frees the port; may be called twice.</summary>
        public void Dispose()
        {
            _isClosing = true;
            _socket.Close();
            _thread.Join();
        }

        private void Listen()
        {
            byte[] datagram = new byte[MaxDatagramBytes];
            while (!_isClosing)
            {
                try
                {
                    int size = _socket.Receive(datagram);
                    lock (_gate)
                    {
                        _collector.Take(datagram, size, _clock.Elapsed.TotalSeconds);
                    }
                }
                catch (ObjectDisposedException)
                {
                    return; // closed
                }
                catch (SocketException error)
                {
                    if (error.SocketErrorCode != SocketError.TimedOut && !_isClosing)
                    {
                        Thread.Sleep(PauseMilliseconds); // the network may come back
                    }
                }
            }
        }
    }
}
