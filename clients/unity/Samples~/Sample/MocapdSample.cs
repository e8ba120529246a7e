using UnityEngine;

namespace Mocapd.Sample
{
    /// <summary>
    /// Put this on an empty object of an empty scene and press Play: a floor, a light, a figure of capsules that stands as the
    /// person does, and what the receiver says. Give it a humanoid, too, and that one moves beside it.
    /// </summary>
    public sealed class MocapdSample : MonoBehaviour
    {
        private const float Thickness = 0.09f; // of the limbs [m]
        private const float HeadSize = 0.22f; // [m]
        private static readonly Color LeftColour = new Color(0.85f, 0.35f, 0.2f);
        private static readonly Color RightColour = new Color(0.2f, 0.45f, 0.85f);
        private static readonly Color TrunkColour = new Color(0.8f, 0.8f, 0.75f);

        [Tooltip("A humanoid of yours in the scene; may be empty.")]
        [SerializeField] private Animator avatar;

        private readonly Transform[] _limbs = new Transform[Bones.Count];
        private MocapdReceiver _receiver;
        private Transform _head;

        private void Start()
        {
            _receiver = gameObject.AddComponent<MocapdReceiver>();
            MakeScenery();
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                if (Bones.ParentOf(bone) != Bones.NoParent)
                {
                    _limbs[bone] = Part(PrimitiveType.Capsule, ColourOf(bone));
                }
            }
            _head = Part(PrimitiveType.Sphere, TrunkColour);
            _head.localScale = Vector3.one * HeadSize;
            if (avatar != null)
            {
                avatar.gameObject.SetActive(false); // so that it is enabled with a receiver
                MocapdAvatar follower = avatar.gameObject.AddComponent<MocapdAvatar>();
                follower.Receiver = _receiver;
                avatar.gameObject.SetActive(true);
            }
        }

        private void LateUpdate()
        {
            Frame frame = _receiver.NewestOf(0);
            Tracking tracking = _receiver.TrackingOf(0);
            bool isTracked = frame != null && (tracking == Tracking.Live || tracking == Tracking.Coasting);
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                if (_limbs[bone] == null)
                {
                    continue;
                }
                bool isKnown = isTracked && frame.Has((Bone)bone);
                _limbs[bone].gameObject.SetActive(isKnown);
                if (isKnown)
                {
                    Place(_limbs[bone], frame[(Bone)Bones.ParentOf(bone)], frame[(Bone)bone]);
                }
            }
            bool hasHead = isTracked && frame.Has(Bone.Head);
            _head.gameObject.SetActive(hasHead);
            if (hasHead)
            {
                Quaternion turn = frame[Bone.Head].Rotation.ToQuaternion();
                _head.localPosition = frame[Bone.Head].Position.ToVector3() + (turn * Vector3.up * (0.5f * HeadSize));
            }
        }

        private void OnGUI()
        {
            GUI.Label(new Rect(16f, 12f, Screen.width - 32f, 64f), _receiver.Status(0));
        }

        // Unity's capsule is 2 m long, along its Y.
        private static void Place(Transform limb, JointPose from, JointPose to)
        {
            Vector3 start = from.Position.ToVector3();
            Vector3 along = to.Position.ToVector3() - start;
            limb.localPosition = start + (along * 0.5f);
            limb.localRotation = Quaternion.FromToRotation(Vector3.up, along);
            limb.localScale = new Vector3(Thickness, 0.5f * along.magnitude, Thickness);
        }

        private static Color ColourOf(int bone)
        {
            string name = Bones.UnityName(bone);
            if (name.StartsWith("Left", System.StringComparison.Ordinal))
            {
                return LeftColour;
            }
            return name.StartsWith("Right", System.StringComparison.Ordinal) ? RightColour : TrunkColour;
        }

        private Transform Part(PrimitiveType shape, Color colour)
        {
            GameObject part = GameObject.CreatePrimitive(shape);
            part.GetComponent<Renderer>().material.color = colour;
            part.transform.SetParent(transform, false);
            return part.transform;
        }

        private void MakeScenery()
        {
            Part(PrimitiveType.Plane, new Color(0.35f, 0.38f, 0.36f)).localScale = Vector3.one * 0.6f; // of 10 m
            GameObject sun = new GameObject("Sun");
            sun.AddComponent<Light>().type = LightType.Directional;
            sun.transform.rotation = Quaternion.Euler(50f, 160f, 0f);
            Camera view = Camera.main;
            if (view == null)
            {
                view = new GameObject("Camera").AddComponent<Camera>();
            }
            view.transform.position = new Vector3(0f, 1.2f, 3.2f);
            view.transform.rotation = Quaternion.Euler(0f, 180f, 0f); // a person at rest faces +Z
        }
    }
}
