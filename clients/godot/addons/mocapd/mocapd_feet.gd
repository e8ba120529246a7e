# How high an avatar's hips are while its feet stand where the person's do: Skeleton3D.motion_scale by the pose.
#
# The legs' lengths alone leave out how high the ankles are over the soles and how far below the hips the legs begin,
# which differ from avatar to avatar. Keeps to what Godot 3 and Godot 4 both run.

# Of mocapd's body, in distances from ankle to toes: the height of both joints over the sole of a flat foot.
const ANKLE_HEIGHT = 0.537
const TOES_HEIGHT = 0.234

const SIDES = ["left", "right"]
const LEG = ["UpperLeg", "LowerLeg", "Foot", "Toes"]  # each is the parent of the next one
const LOWEST_HIPS_M = 0.05  # below that nothing is scaled


# The bones whose joints must be known, by VRM 1.0 name.
static func bones() -> Array:
	var out: Array = ["hips"]
	for side in SIDES:
		for part in LEG:
			out.append(side + part)
	return out


# By what the height of the person's hips is multiplied; 0 where that is not known.
#
# joints: of bones(), origin [m] and basis as of mocapd_humanoid.gd. rests_m: of the avatar's bones in the rest pose,
# the origin in the axes of the bone above; without toes an avatar stands on its ankles. heights_m: of the avatar's
# feet and toes in the rest pose, over the floor.
static func motion_scale(joints: Dictionary, rests_m: Dictionary, heights_m: Dictionary) -> float:
	var hips_m: float = joints["hips"][0].y
	var persons_leg_m: float = 0.0
	var avatars_leg_m: float = 0.0
	var persons_clearance_m: float = INF  # between the lower sole and the floor
	var avatars_lowest_m: float = INF  # the lower sole, from the hips
	for side in SIDES:
		var ankle: Vector3 = joints[side + "Foot"][0]
		var toes: Vector3 = joints[side + "Toes"][0]
		var foot_m: float = (toes - ankle).length()
		persons_clearance_m = min(persons_clearance_m, ankle.y - ANKLE_HEIGHT * foot_m)
		persons_clearance_m = min(persons_clearance_m, toes.y - TOES_HEIGHT * foot_m)
		avatars_lowest_m = min(avatars_lowest_m, _lowest_m(joints, rests_m, heights_m, side))
		for part in ["LowerLeg", "Foot"]:
			var above: String = side + LEG[LEG.find(part) - 1]
			persons_leg_m += (joints[side + part][0] - joints[above][0]).length()
			avatars_leg_m += rests_m[side + part].length()
	if hips_m < LOWEST_HIPS_M or persons_leg_m == 0.0:
		return 0.0
	# a jump is as high as the avatar's legs are long; tracked below the floor, the person stands on it
	var jump_m: float = max(0.0, persons_clearance_m) * avatars_leg_m / persons_leg_m
	return (jump_m - avatars_lowest_m) / hips_m


# The avatar's sole of one side in the person's pose, from its hips upwards.
static func _lowest_m(
	joints: Dictionary, rests_m: Dictionary, heights_m: Dictionary, side: String
) -> float:
	var at_m: float = 0.0
	var above: String = "hips"
	var lowest_m: float = INF
	for part in LEG:
		var bone: String = side + part
		if not rests_m.has(bone):
			continue
		var basis: Basis = joints[above][1]
		var rest: Vector3 = rests_m[bone]
		at_m += (basis.x * rest.x + basis.y * rest.y + basis.z * rest.z).y
		if heights_m.has(bone):
			lowest_m = min(lowest_m, at_m - heights_m[bone])
		above = bone
	return lowest_m
