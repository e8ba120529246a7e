using System;
using UnityEngine;

namespace Mocapd
{
    /// <summary>
    /// Moves a humanoid avatar as a person does. The avatar's own object is the origin of mocapd's world: put it where the
    /// middle of the play area shall be, and turn it to where a person at rest shall face.
    /// </summary>
    [AddComponentMenu("mocapd/Avatar")]
    public sealed class MocapdAvatar : MonoBehaviour
    {
        // mocapd learns a body's proportions as it goes; a person whose bone differs by more is made anew [m]
        private const float NewBody = 0.02f;

        [SerializeField] private MocapdReceiver receiver;

        [Tooltip("Of the humanoid that moves; the one on this object when empty.")]
        [SerializeField] private Animator animator;

        [Tooltip("Number of the person, as mocapd counts.")]
        [SerializeField] private int person = 0;

        private SourceSkeleton _source;
        private HumanPoseHandler _target;
        private HumanPose _pose;
        private Frame _posed;
        private bool _isRefused;

        /// <summary>Whether the person is tracked now; the avatar keeps the last pose while not.</summary>
        public bool IsTracked { get; private set; }

        public MocapdReceiver Receiver
        {
            get => receiver;
            set => receiver = value;
        }

        public Animator Animator
        {
            get => animator;
            set => animator = value;
        }

        /// <summary>The person's own skeleton; null before the first frame.</summary>
        public SourceSkeleton Source => _source;

        private void OnEnable()
        {
            if (animator == null)
            {
                animator = GetComponent<Animator>();
            }
            bool isHuman = animator != null && animator.avatar != null && animator.avatar.isHuman;
            if (receiver == null || !isHuman)
            {
                string missing = receiver == null ? "no receiver is given" : "there is no Animator with a humanoid avatar";
                Debug.LogError("mocapd: " + missing, this);
                enabled = false;
                return;
            }
            _target = new HumanPoseHandler(animator.avatar, animator.transform);
        }

        private void OnDisable()
        {
            _target?.Dispose();
            _target = null;
            _source?.Dispose();
            _source = null;
            _posed = null;
            _isRefused = false;
            IsTracked = false;
        }

        // After the Animator, which would overwrite the pose
        private void LateUpdate()
        {
            Tracking tracking = receiver.TrackingOf(person);
            IsTracked = tracking == Tracking.Live || tracking == Tracking.Coasting;
            if (IsTracked)
            {
                Follow(receiver.NewestOf(person));
            }
            if (_posed != null)
            {
                _target.SetHumanPose(ref _pose);
            }
        }

        private void Follow(Frame frame)
        {
            if (frame == null || frame == _posed || _isRefused)
            {
                return;
            }
            RestPose rest = RestPose.Of(frame);
            bool isNew = rest != null && (_source == null || _source.Rest.DifferenceFrom(rest) > NewBody);
            if (isNew && !MakeSource(rest))
            {
                return;
            }
            if (_source == null)
            {
                return; // the first frame must have every bone
            }
            _source.Pose(frame);
            _source.Read(ref _pose);
            _posed = frame;
        }

        private bool MakeSource(RestPose rest)
        {
            _source?.Dispose();
            _source = null;
            try
            {
                _source = new SourceSkeleton(rest, "mocapd person " + person);
            }
            catch (InvalidOperationException error)
            {
                _isRefused = true; // said once, not at every frame
                Debug.LogError(error.Message, this);
            }
            return _source != null;
        }
    }
}
