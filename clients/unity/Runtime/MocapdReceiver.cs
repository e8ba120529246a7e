using System.Net;
using System.Net.Sockets;
using UnityEngine;

namespace Mocapd
{
    /// <summary>Listens to mocapd while it is enabled. One for a scene; avatars and your own scripts ask it.</summary>
    [AddComponentMenu("mocapd/Receiver")]
    public sealed class MocapdReceiver : MonoBehaviour
    {
        [Tooltip("UDP port that mocapd sends to: its key osc.destinations.")]
        [SerializeField] private int port = 39541;

        [Tooltip("Hear other machines too, not only this one.")]
        [SerializeField] private bool hearNetwork = false;

        [Tooltip("After so long without a frame there is no tracking [s].")]
        [SerializeField] private float silenceSeconds = 0.5f;

        private FrameReceiver _receiver;
        private string _failure = "the receiver is not enabled";
        private int _kindsSaid;

        /// <summary>Takes effect when it is enabled the next time.</summary>
        public int Port
        {
            get => port;
            set => port = value;
        }

        /// <summary>After so long without a frame there is no tracking [s]; takes effect as the port does.</summary>
        public float SilenceSeconds
        {
            get => silenceSeconds;
            set => silenceSeconds = value;
        }

        /// <summary>The newest frame of a person, in Unity's axes; null before the first.</summary>
        public Frame NewestOf(int person) => _receiver?.NewestOf(person);

        public Tracking TrackingOf(int person) => _receiver?.TrackingOf(person) ?? Tracking.Silent;

        /// <summary>One line for people: who is tracked by whom, or why nobody is, and what was wrong with what came.</summary>
        public string Status(int person) => _receiver == null ? _failure : _receiver.Status(person);

        private void OnEnable()
        {
            _kindsSaid = 0;
            if (port < 1 || port > IPEndPoint.MaxPort)
            {
                Fail("mocapd: port " + port + " is not from 1 to " + IPEndPoint.MaxPort);
                return;
            }
            try
            {
                _receiver = new FrameReceiver(port, hearNetwork ? IPAddress.Any : IPAddress.Loopback, silenceSeconds);
            }
            catch (SocketException error)
            {
                Fail("mocapd: cannot listen on port " + port + ": " + error.Message);
            }
        }

        private void Fail(string why)
        {
            _failure = why;
            Debug.LogError(why, this);
        }

        private void OnDisable()
        {
            _receiver?.Dispose();
            _receiver = null;
            _failure = "the receiver is not enabled";
        }

        private void Update()
        {
            int kinds = _receiver?.TroubleKinds ?? 0;
            if (kinds > _kindsSaid)
            {
                _kindsSaid = kinds;
                Debug.LogWarning("mocapd: " + _receiver.Status(0), this);
            }
        }
    }
}
