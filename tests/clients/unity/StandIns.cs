// Stand-ins for the types of UnityEngine that the package names: enough to compile it against, and to see what it does
// with them. Names and signatures as in Unity's scripting reference; HumanPoseHandler only counts.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;

namespace UnityEngine
{
    public sealed class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string text)
        {
        }
    }

    public sealed class SerializeField : Attribute
    {
    }

    public sealed class AddComponentMenu : Attribute
    {
        public AddComponentMenu(string menuName)
        {
        }
    }

    public class Object
    {
        public static int Alive; // objects of scenes and avatars, which nobody clears away for us

        public string name = string.Empty;

        public static void Destroy(Object thing) => Alive -= thing.Size;

        public static void DestroyImmediate(Object thing) => Destroy(thing);

        internal virtual int Size => 0;
    }

    public static class Application
    {
        public static bool isPlaying => true;
    }

    public static class Screen
    {
        public static int width => 960;
    }

    public static class Debug
    {
        public static readonly List<string> Said = new List<string>();

        public static void LogWarning(object message, Object context) => Said.Add("warning: " + message);

        public static void LogError(object message, Object context) => Said.Add("error: " + message);
    }

    public struct Vector3
    {
        public float x;
        public float y;
        public float z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 one => new Vector3(1f, 1f, 1f);

        public static Vector3 up => new Vector3(0f, 1f, 0f);

        public float magnitude => (float)Math.Sqrt((x * x) + (y * y) + (z * z));

        public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);

        public static Vector3 operator -(Vector3 a, Vector3 b) => new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);

        public static Vector3 operator *(Vector3 a, float d) => new Vector3(a.x * d, a.y * d, a.z * d);
    }

    public struct Quaternion
    {
        public float x;
        public float y;
        public float z;
        public float w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Quaternion identity => new Quaternion(0f, 0f, 0f, 1f);

        public static Quaternion Euler(float x, float y, float z) => identity;

        public static Quaternion FromToRotation(Vector3 fromDirection, Vector3 toDirection) => identity;

        public static Quaternion operator *(Quaternion a, Quaternion b) => new Quaternion(
            (a.w * b.x) + (a.x * b.w) + (a.y * b.z) - (a.z * b.y),
            (a.w * b.y) - (a.x * b.z) + (a.y * b.w) + (a.z * b.x),
            (a.w * b.z) + (a.x * b.y) - (a.y * b.x) + (a.z * b.w),
            (a.w * b.w) - (a.x * b.x) - (a.y * b.y) - (a.z * b.z));

        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            Quaternion turned = q * new Quaternion(v.x, v.y, v.z, 0f) * new Quaternion(-q.x, -q.y, -q.z, q.w);
            return new Vector3(turned.x, turned.y, turned.z);
        }
    }

    public class Component : Object
    {
        public GameObject gameObject { get; internal set; }

        public Transform transform => gameObject.transform;

        public T GetComponent<T>()
            where T : Component => gameObject.GetComponent<T>();
    }

    public class Transform : Component
    {
        private readonly List<Transform> _children = new List<Transform>();
        private Transform _parent;

        public Vector3 localPosition { get; set; }

        public Quaternion localRotation { get; set; } = Quaternion.identity;

        public Vector3 localScale { get; set; } = Vector3.one;

        public Vector3 position
        {
            get => _parent == null ? localPosition : _parent.position + (_parent.rotation * localPosition);
            set => localPosition = value;
        }

        public Quaternion rotation
        {
            get => _parent == null ? localRotation : _parent.rotation * localRotation;
            set => localRotation = value;
        }

        public void SetParent(Transform parent, bool worldPositionStays)
        {
            _parent = parent;
            parent._children.Add(this);
        }

        internal override int Size => _children.Sum(child => child.gameObject.Size);
    }

    public class GameObject : Object
    {
        private readonly List<Component> _components = new List<Component>();
        private bool _isActive = true;

        public GameObject(string name)
        {
            Alive++;
            this.name = name;
            transform = new Transform { gameObject = this, name = name };
        }

        public Transform transform { get; }

        internal override int Size => 1 + transform.Size;

        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            GameObject made = new GameObject(type.ToString());
            made.AddComponent<Renderer>();
            return made;
        }

        public T AddComponent<T>()
            where T : Component, new()
        {
            T component = new T { gameObject = this };
            _components.Add(component);
            if (_isActive)
            {
                (component as MonoBehaviour)?.Call("OnEnable");
            }
            return component;
        }

        public T GetComponent<T>()
            where T : Component => _components.Find(one => one is T) as T;

        public void SetActive(bool value)
        {
            if (value == _isActive)
            {
                return;
            }
            _isActive = value;
            foreach (Component component in _components)
            {
                MonoBehaviour behaviour = component as MonoBehaviour;
                if (behaviour != null && behaviour.enabled)
                {
                    behaviour.Call(value ? "OnEnable" : "OnDisable");
                }
            }
        }
    }

    public class Behaviour : Component
    {
        public bool enabled { get; set; } = true;
    }

    public class MonoBehaviour : Behaviour
    {
        // As the engine does: by name, whatever its access is.
        public void Call(string message)
        {
            const BindingFlags any = BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic;
            GetType().GetMethod(message, any)?.Invoke(this, null);
        }
    }

    public sealed class Avatar : Object
    {
        public bool isValid => true;

        public bool isHuman { get; set; } = true;

        public Avatar()
        {
            Alive++;
        }

        internal override int Size => 1;
    }

    public sealed class Animator : Behaviour
    {
        public Avatar avatar { get; set; }
    }

    public struct HumanLimit
    {
        public bool useDefaultValues { get; set; }
    }

    public struct HumanBone
    {
        public HumanLimit limit;

        public string boneName { get; set; }

        public string humanName { get; set; }
    }

    public struct SkeletonBone
    {
        public string name;
        public Vector3 position;
        public Quaternion rotation;
        public Vector3 scale;
    }

    public struct HumanDescription
    {
        public HumanBone[] human;
        public SkeletonBone[] skeleton;

        public float upperArmTwist { get; set; }

        public float lowerArmTwist { get; set; }

        public float upperLegTwist { get; set; }

        public float lowerLegTwist { get; set; }

        public float armStretch { get; set; }

        public float legStretch { get; set; }
    }

    public static class AvatarBuilder
    {
        public static HumanDescription Last;

        public static Avatar BuildHumanAvatar(GameObject go, HumanDescription humanDescription)
        {
            Last = humanDescription;
            return new Avatar();
        }
    }

    public struct HumanPose
    {
        public Vector3 bodyPosition;
        public Quaternion bodyRotation;
        public float[] muscles;
    }

    public sealed class HumanPoseHandler : IDisposable
    {
        public static int Open;
        public static int Sets;

        public HumanPoseHandler(Avatar avatar, Transform root)
        {
            Open++;
        }

        public void Dispose() => Open--;

        public void GetHumanPose(ref HumanPose humanPose)
        {
            humanPose.muscles = humanPose.muscles ?? new float[95];
        }

        public void SetHumanPose(ref HumanPose humanPose) => Sets++;
    }

    public enum PrimitiveType
    {
        Sphere,
        Capsule,
        Plane,
    }

    public enum LightType
    {
        Directional,
    }

    public struct Color
    {
        public Color(float r, float g, float b)
        {
        }
    }

    public sealed class Material : Object
    {
        public Color color { get; set; }
    }

    public sealed class Renderer : Component
    {
        public Material material { get; } = new Material();
    }

    public sealed class Light : Behaviour
    {
        public LightType type { get; set; }
    }

    public sealed class Camera : Behaviour
    {
        public static Camera main => null;
    }

    public struct Rect
    {
        public Rect(float x, float y, float width, float height)
        {
        }
    }

    public static class GUI
    {
        public static string Said = string.Empty;

        public static void Label(Rect position, string text) => Said = text;
    }
}
