#include "base/text.h"
#include "vrml/behaviours/animation/h_anim.h"
#include "vrml/behaviours/animation/rotations.h"
#include "vrml/events/execution.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

// HAnimMotion: recorded motion of a humanoid (ISO/IEC 19774-2), as in BVH files.
namespace gs::vrml {
namespace {

struct MotionEvents {
  enum : int {
    next,
    previous,
    enabled,
    values,
    frame_index,
    cycle_time,
    elapsed_time,
    frame_count,
    channels,
    joints,
    loop,
    frame_increment
  };
};
using Channel = MotionState::Channel;

MotionState& motion_state(Execution& execution, EventNode node) {
  return execution.states().motions[execution.nodes().state_of(node)];
}

// Calls `visit` for each word of a list that is separated by blanks and commas.
template <class Visit>
void for_words(std::string_view text, const Visit& visit) {
  constexpr std::string_view kBlanks = " \t\r\n,";
  while (true) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == text.npos) return;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    visit(word);
    text.remove_prefix(word.size());
  }
}

// Returns a name of a joint without case and underscores: HAnim 1.1 has HumanoidRoot, HAnim 2.0 has humanoid_root.
std::string plain_joint_name(std::string_view name) {
  std::string plain = lower_case(name);
  std::erase(plain, '_');
  return plain;
}

Channel channel_named(std::string_view name) {
  static constexpr std::pair<std::string_view, Channel> kNames[] = {
      {"Xposition", Channel::x_position}, {"Yposition", Channel::y_position}, {"Zposition", Channel::z_position},
      {"Xrotation", Channel::x_rotation}, {"Yrotation", Channel::y_rotation}, {"Zrotation", Channel::z_rotation}};
  return value_named(kNames, name).value_or(Channel::none);
}

// Reads the channels of all joints: per joint, their number and their names.
std::vector<std::vector<Channel>> channels_of(std::string_view text) {
  std::vector<std::vector<Channel>> channels;
  for_words(text, [&](std::string_view word) {
    if (std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; }))
      channels.emplace_back();
    else if (!channels.empty())
      channels.back().push_back(channel_named(word));
  });
  return channels;
}

std::size_t frames_of(Execution& execution, EventNode node, const MotionState& state) {
  return state.numbers == 0 ? 0 : execution.get<MFFloat>(node, MotionEvents::values).size() / state.numbers;
}

template <class T>
T motion_field(Execution& execution, EventNode node, const char* name) {
  const NodePlace at = execution.nodes().place_of(node);
  return at.scene->get<T>(at.node, name);
}

/// Range of frames that play.
struct FrameRange {
  std::int64_t first = 0, count = 0;
};
FrameRange range_of(Execution& execution, EventNode node, const MotionState& state) {
  const auto frames = static_cast<std::int64_t>(frames_of(execution, node, state));
  const std::int64_t first = motion_field<SFInt32>(execution, node, "startFrame");
  const std::int64_t last = motion_field<SFInt32>(execution, node, "endFrame");
  const bool given = first >= 0 && last > first && last < frames;
  return given ? FrameRange{first, last - first + 1} : FrameRange{0, frames};
}

// Sets the joints to a frame.
void show_frame(Execution& execution, EventNode node, std::int64_t frame) {
  const MotionState& state = motion_state(execution, node);
  const MFFloat& values = execution.get<MFFloat>(node, MotionEvents::values);
  const auto begin = static_cast<std::size_t>(frame) * state.numbers;
  if (frame < 0 || begin + state.numbers > values.size() || !execution.budget().spend(state.numbers)) return;
  std::size_t at = begin;
  for (const MotionState::Track& track : state.tracks) {
    glm::dquat rotation(1, 0, 0, 0);
    SFVec3f position(0);
    bool moves = false, turns = false;
    for (const Channel channel : track.channels) {
      const auto value = static_cast<double>(values[at++]);
      if (channel == Channel::none || !std::isfinite(value)) continue;
      const bool is_position = channel <= Channel::z_position;
      const int axis =
          static_cast<int>(channel) - static_cast<int>(is_position ? Channel::x_position : Channel::x_rotation);
      (is_position ? moves : turns) = true;
      if (is_position) {
        position[axis] = static_cast<float>(value);
      } else {
        glm::dvec3 direction(0);
        direction[axis] = 1;
        rotation = rotation * glm::angleAxis(glm::radians(value), direction);
      }
    }
    if (track.joint == 0 || execution.nodes().is_removed(track.joint)) continue;
    const NodeType& type = execution.nodes().type_of(track.joint);
    if (moves) set_field(execution, track.joint, *type.find_field("translation"), position);
    if (turns) set_field(execution, track.joint, *type.find_field("rotation"), rotation_of(rotation));
  }
  if (!execution.nodes().is_removed(state.humanoid)) execution.timers().look_again(state.humanoid);
}

void begin_motion(Execution& execution, EventNode node) {
  if (execution.nodes().state_of(node) == 0) execution.nodes().state_of(node) = execution.states().motions.take();
}
void end_motion(Execution& execution, EventNode node) {
  execution.states().motions.give_back(execution.nodes().state_of(node));
}

// Reports whether the humanoid allows the motion (HAnimHumanoid, motionsEnabled). Without a value it does.
bool is_allowed(Execution& execution, const MotionState& state) {
  if (state.humanoid == 0 || execution.nodes().is_removed(state.humanoid)) return true;
  const auto allowed = motion_field<MFBool>(execution, state.humanoid, "motionsEnabled");
  return state.number >= allowed.size() || allowed[state.number];
}

void play(Execution& execution, EventNode node) {
  MotionState& state = motion_state(execution, node);
  const FrameRange range = range_of(execution, node, state);
  const auto duration = motion_field<SFTime>(execution, node, "frameDuration");
  const bool plays = execution.get<SFBool>(node, MotionEvents::enabled) && is_allowed(execution, state) &&
                     range.count > 0 && duration > 0;
  execution.timers().run(node, plays);
  if (!plays) {
    state.start = -1;
    return;
  }
  const double now = execution.now();
  if (state.start < 0) {
    state.start = now;
    execution.send(node, MotionEvents::frame_count, static_cast<SFInt32>(frames_of(execution, node, state)));
    execution.send(node, MotionEvents::cycle_time, SFTime{now});
  }
  const double length = duration * static_cast<double>(range.count);
  double elapsed = now - state.start;
  if (elapsed >= length) {
    if (!execution.get<SFBool>(node, MotionEvents::loop)) {
      show_frame(execution, node, range.first + range.count - 1);
      execution.send(node, MotionEvents::enabled, SFBool{false});
      execution.timers().run(node, false);
      return;
    }
    const double cycles = std::floor(elapsed / length);
    state.start += cycles * length;
    elapsed -= cycles * length;
    execution.send(node, MotionEvents::cycle_time, SFTime{state.start});
  }
  const auto frame = std::min(static_cast<std::int64_t>(elapsed / duration), range.count - 1);
  execution.send(node, MotionEvents::elapsed_time, SFTime{elapsed});
  const auto shown = static_cast<SFInt32>(range.first + frame);
  if (execution.get<SFInt32>(node, MotionEvents::frame_index) == shown && elapsed > 0) return;
  execution.send(node, MotionEvents::frame_index, shown);
  show_frame(execution, node, shown);
}

// Shows another frame while the motion rests.
void step_frame(Execution& execution, EventNode node, std::int64_t step) {
  const FrameRange range = range_of(execution, node, motion_state(execution, node));
  if (range.count == 0) return;
  const std::int64_t old = execution.get<SFInt32>(node, MotionEvents::frame_index) - range.first;
  const std::int64_t place = ((old + step) % range.count + range.count) % range.count;
  execution.send(node, MotionEvents::frame_index, static_cast<SFInt32>(range.first + place));
  show_frame(execution, node, range.first + place);
}

bool motion_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  const std::int64_t increment = execution.get<SFInt32>(node, MotionEvents::frame_increment);
  switch (event) {
    case MotionEvents::next:
      if (std::get<SFBool>(value)) step_frame(execution, node, increment);
      return false;
    case MotionEvents::previous:
      if (std::get<SFBool>(value)) step_frame(execution, node, -increment);
      return false;
    case MotionEvents::frame_index:
      show_frame(execution, node, std::get<SFInt32>(value));
      return true;
    case MotionEvents::enabled:
      execution.timers().look_again(node);
      return true;
    default:
      return true;
  }
}

}  // namespace

void attach_motion(Execution& execution, EventNode motion, EventNode humanoid, std::size_t number,
                   const HumanoidState& skeleton) {
  begin_motion(execution, motion);
  MotionState& state = motion_state(execution, motion);
  state = {};
  state.humanoid = humanoid;
  state.number = number;
  SceneGraph& scene = *execution.nodes()[humanoid].scene;
  SceneState* const world = execution.scenes().find(&scene);
  std::vector<std::vector<Channel>> channels =
      channels_of(execution.get<SFString>(motion, MotionEvents::channels).view());
  for_words(execution.get<SFString>(motion, MotionEvents::joints).view(), [&](std::string_view name) {
    if (state.tracks.size() == channels.size() || !execution.budget().spend(skeleton.joints.size())) return;
    MotionState::Track& track = state.tracks.emplace_back();
    track.channels = std::move(channels[state.tracks.size() - 1]);
    state.numbers += track.channels.size();
    const std::string wanted = plain_joint_name(name);
    for (const HumanoidState::Joint& joint : skeleton.joints)
      if (plain_joint_name(scene.get<SFString>(joint.node, "name").view()) == wanted)
        track.joint = execution.scenes().member(*world, joint.node);
  });
  execution.timers().look_again(motion);
}

const Behaviour kMotionBehaviour = {
    .events = {"next", "previous", "enabled", "values", "frameIndex", "cycleTime", "elapsedTime", "frameCount",
               "channels", "joints", "loop", "frameIncrement"},
    .initialize = begin_motion,
    .on_event = motion_event,
    .on_time = play,
    .on_remove = end_motion,
};

}  // namespace gs::vrml
