// The package's components on stand-ins for UnityEngine, as the engine would call them.
using System.Collections.Generic;
using Mocapd.Sample;
using UnityEngine;

namespace Mocapd.Tests
{
    public static class Scene
    {
        private const float Patient = 600f; // no machine is so slow that a stream seems silent [s]

        public static string Played(List<byte[]> golden, byte[] lost, int port)
        {
            int before = Object.Alive;
            GameObject place = new GameObject("scene");
            place.SetActive(false);
            MocapdReceiver receiver = place.AddComponent<MocapdReceiver>();
            receiver.Port = port;
            receiver.SilenceSeconds = Patient;
            Animator animator = place.AddComponent<Animator>();
            animator.avatar = new Avatar();
            MocapdAvatar avatar = place.AddComponent<MocapdAvatar>();
            avatar.Receiver = receiver;
            place.SetActive(true);

            avatar.Call("LateUpdate"); // nothing has come
            int setsBefore = HumanPoseHandler.Sets;
            bool trackedBefore = avatar.IsTracked;

            PlayStreams.Send(golden, port);
            PlayStreams.Eventually(() => receiver.NewestOf(0) != null);
            avatar.Call("LateUpdate");
            string joints = Joints(avatar.Source);
            int setsPosed = HumanPoseHandler.Sets;
            bool trackedPosed = avatar.IsTracked;
            int scenery = Object.Alive;

            // a game that goes on while nobody is seen, and while something else sends to the port
            PlayStreams.Send(new[] { lost, new byte[] { 1, 2, 3 } }, port);
            PlayStreams.Eventually(() => receiver.TrackingOf(0) == Tracking.Lost && receiver.Status(0).Contains("no OSC"));
            receiver.Call("Update");
            receiver.Call("Update");
            avatar.Call("LateUpdate");
            bool trackedLost = avatar.IsTracked;
            int setsLost = HumanPoseHandler.Sets;

            place.SetActive(false);
            int openAfter = HumanPoseHandler.Open;
            int left = Object.Alive - before;
            place.SetActive(true); // the port is free again
            string anew = receiver.Status(0);
            place.SetActive(false);
            receiver.Port = 70000;
            place.SetActive(true);
            string impossible = receiver.Status(0);
            place.SetActive(false);

            GameObject bare = new GameObject("bare");
            bare.AddComponent<MocapdAvatar>(); // without a receiver and without a humanoid
            return "{\"joints\":" + joints + ",\"sets\":[" + setsBefore + "," + setsPosed + "," + setsLost + "],\"tracked\":["
                + PlayStreams.Json(trackedBefore) + "," + PlayStreams.Json(trackedPosed) + ","
                + PlayStreams.Json(trackedLost) + "],\"open\":" + openAfter
                + ",\"left\":" + left + ",\"made\":" + (scenery - before) + ",\"human\":" + AvatarBuilder.Last.human.Length
                + ",\"anew\":" + PlayStreams.Json(anew) + ",\"impossible\":" + PlayStreams.Json(impossible) + ",\"said\":" + Said() + "}";
        }

        public static string PlayedSample(List<byte[]> golden, int port)
        {
            GameObject place = new GameObject("sample");
            MocapdSample sample = place.AddComponent<MocapdSample>();
            sample.Call("Start");
            MocapdReceiver receiver = place.GetComponent<MocapdReceiver>();
            receiver.Call("OnDisable"); // whoever has the usual port on this machine
            receiver.Port = port;
            receiver.SilenceSeconds = Patient;
            receiver.Call("OnEnable");
            sample.Call("LateUpdate");
            PlayStreams.Send(golden, port);
            PlayStreams.Eventually(() => receiver.NewestOf(0) != null);
            sample.Call("LateUpdate");
            sample.Call("OnGUI");
            receiver.Call("OnDisable");
            return PlayStreams.Json(GUI.Said);
        }

        private static string Joints(SourceSkeleton source)
        {
            List<string> joints = new List<string>();
            for (int bone = 0; bone < Bones.Count; bone++)
            {
                Vector3 at = source[(Bone)bone].position;
                joints.Add(PlayStreams.Json(Bones.UnityName(bone)) + ":" + PlayStreams.Json(at.x, at.y, at.z));
            }
            return "{" + string.Join(",", joints) + "}";
        }

        private static string Said() => "[" + string.Join(",", Debug.Said.ConvertAll(PlayStreams.Json)) + "]";
    }
}
