#include "vrml/behaviours/browser_events.h"
#include "vrml/behaviours/pauses.h"
#include "vrml/event_model/behaviour.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::vrml {
namespace {

// Interfaces of AudioClip and MovieTexture. `rate` is the pitch or the speed.
struct Media {
  enum : int {
    loop,
    rate,
    start_time,
    stop_time,
    duration_changed,
    is_active,
    url,
    media_time,
    pause_time,
    resume_time,
    is_paused,
    elapsed_time,
    enabled
  };
};
constexpr PauseEvents kMediaPauseEvents = {Media::start_time, Media::pause_time, Media::resume_time, Media::is_paused,
                                           Media::elapsed_time};

constexpr double kUnending = std::numeric_limits<double>::infinity();

MediaState& state_of_media(Execution& execution, EventNode node) {
  return execution.states().media[execution.nodes().state_of(node)];
}

struct MediaFields {
  double start, stop, rate;
  bool loop;
};

MediaFields media_fields(Execution& execution, EventNode node, bool backwards) {
  MediaFields f{execution.get<SFTime>(node, Media::start_time), execution.get<SFTime>(node, Media::stop_time),
                execution.get<SFFloat>(node, Media::rate), execution.get<SFBool>(node, Media::loop)};
  // Replaces values that the standard forbids by the default: a pitch outside (0,inf), and numbers that are not finite.
  if (!std::isfinite(f.rate) || (!backwards && !(f.rate > 0))) f.rate = 1;
  // Moves the start by the pauses, so that the media continues after them.
  if (!(f.stop > f.start)) f.stop = kUnending;
  f.start += state_of_media(execution, node).pause.total;
  return f;
}

MediaFields media_fields(Execution& execution, EventNode node) {
  return media_fields(execution, node, execution.nodes().behaviour_of(node).media_backwards);
}

// Returns the duration of one cycle in seconds (6.4, 6.28). Returns infinity if the duration is unknown or the rate is
// 0.
double cycle_of(const MediaFields& f, const MediaState& state) {
  return state.duration >= 0 && f.rate != 0 ? state.duration / std::abs(f.rate) : kUnending;
}

// Reports whether the node may be active. Nodes of VRML97 always may.
bool is_enabled(Execution& execution, EventNode node) {
  return !execution.nodes().has_event(node, Media::enabled) || execution.get<SFBool>(node, Media::enabled);
}

// Reports whether the sound or movie may still load. Otherwise the node has no cycle.
bool may_come(Execution& execution, EventNode node, const MediaState& state) {
  return !state.told && !execution.get<MFString>(node, Media::url).empty();
}

double end_of(const MediaFields& f, const MediaState& state) {
  const double stop = f.stop > f.start ? f.stop : kUnending;
  return f.loop ? stop : std::min(stop, f.start + (state.cycle + 1) * cycle_of(f, state));
}

// Returns the media time at `time`, in seconds: t in 6.4 and 6.28.
double position_at(const MediaFields& f, const MediaState& state, double time, bool end_of_cycle) {
  const bool known = state.duration >= 0;
  if (f.rate == 0) return 0;
  double played = std::max(0.0, time - f.start) * std::abs(f.rate);
  if (known) played = end_of_cycle ? state.duration : state.duration > 0 ? std::fmod(played, state.duration) : 0;
  if (f.rate > 0) return played;
  return known ? state.duration - played : 0;
}

void media_start_if_due(Execution& execution, EventNode node, MediaState& state) {
  const MediaFields f = media_fields(execution, node);
  const double now = execution.now();
  const bool delayed = std::exchange(state.delayed, false);
  if (!is_enabled(execution, node)) return;
  if (f.start > now) {
    execution.timers().call_at(node, f.start);
    return;
  }
  const bool since_last_step = delayed || f.start > execution.cascade().previous();
  const bool stopped = f.stop > f.start && now >= f.stop;
  if (!(f.start <= now) || (stopped && !since_last_step)) return;
  if (!f.loop) {
    // If the duration is unknown, starts only if the media may still load and startTime is after the last step.
    if (state.duration < 0 && (!may_come(execution, node, state) || !since_last_step)) return;
    if (state.duration >= 0 && now >= f.start + cycle_of(f, state) && !since_last_step) return;
  }
  if (execution.has_sent(node, Media::is_active)) {
    state.delayed = true;
    execution.timers().call_at(node, now);
    return;
  }
  state.active = true;
  state.cycle = 0;
  begin_pauses(state.pause, f.start > execution.cascade().previous() ? f.start : now);
  execution.send(node, Media::is_active, SFBool{true});
  if (has_pauses(execution, node, kMediaPauseEvents)) return execution.timers().look_again(node);
  execution.timers().call_at(node, end_of(f, state));
}

void media_stop(Execution& execution, EventNode node, MediaState& state, const MediaFields& f, double end) {
  const bool end_of_cycle = !f.loop && end >= f.start + (state.cycle + 1) * cycle_of(f, state);
  // If stopTime was set to the past while active, the activity ends at the time of that event.
  const double last = state.pause.paused ? state.pause.since : std::max(end, state.stop_set);
  state.held = position_at(f, state, last, end_of_cycle);
  state.holds = true;
  state.active = false;
  end_pauses(execution, node, kMediaPauseEvents, state.pause);
  execution.send(node, Media::is_active, SFBool{false});
  // If the node must stop and start again at the same time, it stops first (4.6.9).
  if (state.new_start_at == execution.now()) {
    execution.send(node, Media::start_time, SFTime{state.new_start});
    media_start_if_due(execution, node, state);
  }
}

// Sends mediaTime and elapsedTime in each step of the active period, if another node listens.
void tell_media_time(Execution& execution, EventNode node, const MediaState& state) {
  const bool plays = state.active && !state.pause.paused;
  const bool tells = plays && execution.routes().is_listened_to(node, Media::media_time);
  const bool counts = plays && execution.routes().is_listened_to(node, Media::elapsed_time);
  execution.timers().run(node, tells || counts);
  if (counts) send_elapsed(execution, node, kMediaPauseEvents, state.pause, execution.now());
  if (!tells || execution.has_sent(node, Media::media_time)) return;
  execution.send(node, Media::media_time,
                 SFTime{position_at(media_fields(execution, node), state, execution.now(), false)});
}

// Begins and ends pauses of an active node. Returns the time of the next change.
double media_pauses(Execution& execution, EventNode node, MediaState& state) {
  if (!has_pauses(execution, node, kMediaPauseEvents)) return kUnending;
  const double last = std::max(state.pause.activated, execution.cascade().previous());
  if (!begin_pause(execution, node, kMediaPauseEvents, state.pause, last))
    resume(execution, node, kMediaPauseEvents, state.pause);
  return state.pause.paused ? next_resume(execution, node, kMediaPauseEvents)
                            : next_pause(execution, node, kMediaPauseEvents);
}

void media_change(Execution& execution, EventNode node, MediaState& state) {
  if (!state.active) {
    media_start_if_due(execution, node, state);
    return;
  }
  const double change = media_pauses(execution, node, state);
  const MediaFields f = media_fields(execution, node);
  const bool over =
      !is_enabled(execution, node) || (!f.loop && state.duration < 0 && !may_come(execution, node, state));
  const double next = state.pause.paused ? f.stop : end_of(f, state);
  const double end = over ? std::min(next, execution.now()) : next;
  if (execution.now() < end) {
    execution.timers().call_at(node, std::min(end, change));
  } else if (execution.has_sent(node, Media::is_active)) {
    execution.timers().call_at(node, execution.now());  // already started with this timestamp; stops with the next
  } else {
    media_stop(execution, node, state, f, end);
  }
}

void media_time(Execution& execution, EventNode node) {
  MediaState& state = state_of_media(execution, node);
  media_change(execution, node, state);
  tell_media_time(execution, node, state);
}

// Handles events while the node is active (4.6.9, 6.4, 6.28). Ignores set_startTime, set_pitch and set_speed. Ignores a
// set_stopTime that is not after startTime.
bool media_event(Execution& execution, EventNode node, int event, const FieldValue& value) {
  MediaState& state = state_of_media(execution, node);
  execution.timers().look_again(node);
  if (!state.active) return true;
  const MediaFields f = media_fields(execution, node);
  switch (event) {
    case Media::rate:
      return false;
    case Media::stop_time:
      if (!(std::get<SFTime>(value) > execution.get<SFTime>(node, Media::start_time))) return false;
      state.stop_set = execution.now();
      return true;
    case Media::start_time:
      state.new_start = std::get<SFTime>(value);
      state.new_start_at = execution.now();
      return false;
    case Media::loop: {
      // If `loop` becomes FALSE, the current cycle is the last one.
      const double cycles = (execution.now() - f.start) / cycle_of(f, state);
      state.cycle = f.loop && std::isfinite(cycles) ? std::max(0.0, std::floor(cycles)) : state.cycle;
      return true;
    }
    default:
      return true;
  }
}

void media_begin(Execution& execution, EventNode node) {
  auto& media = execution.states().media;
  if (!media.has_spare() && !execution.budget().afford(sizeof(MediaState))) return;
  execution.nodes().state_of(node) = media.take();
  execution.timers().look_again(node);
}

void media_removed(Execution& execution, EventNode node) {
  execution.states().media.give_back(execution.nodes().state_of(node));
}

// Takes the duration of loaded media. Returns false if an event was already sent with this timestamp.
bool media_came(Execution& execution, EventNode node, double duration) {
  if (execution.has_sent(node, Media::duration_changed)) return false;
  MediaState& state = state_of_media(execution, node);
  state.told = true;
  state.duration = duration >= 0 && std::isfinite(duration) ? duration : -1;
  execution.send(node, Media::duration_changed, SFTime{state.duration});
  execution.timers().look_again(node);
  return true;
}

MediaPlay media_play(Execution& execution, EventNode node) {
  const MediaState& state = state_of_media(execution, node);
  const MediaFields f = media_fields(execution, node);
  MediaPlay play;
  play.active = state.active && !state.pause.paused;
  play.loop = f.loop;
  play.start = f.start;
  play.end = end_of(f, state);
  play.rate = f.rate;
  play.duration = state.duration;
  const double now = state.pause.paused ? state.pause.since : execution.now();
  play.position = state.active  ? position_at(f, state, now, false)
                  : state.holds ? state.held
                                : position_at(f, state, f.start, false);
  return play;
}

constexpr Behaviour media_behaviour(std::string_view rate, bool backwards) {
  Behaviour behaviour;
  behaviour.events = {"loop", rate,        "startTime",  "stopTime", "duration_changed", "isActive", "url",
                      "",     "pauseTime", "resumeTime", "isPaused", "elapsedTime",      "enabled"};
  // mediaTime is an event of other browsers; only movies have it.
  if (backwards) behaviour.events[Media::media_time] = "mediaTime";
  behaviour.watches_routes = true;
  behaviour.initialize = media_begin;
  behaviour.on_event = media_event;
  behaviour.on_time = media_time;
  behaviour.on_remove = media_removed;
  behaviour.media_came = media_came;
  behaviour.media_play = media_play;
  behaviour.media_backwards = backwards;
  return behaviour;
}

}  // namespace

constexpr Behaviour kAudioClipBehaviour = media_behaviour("pitch", false);
constexpr Behaviour kMovieTextureBehaviour = media_behaviour("speed", true);

}  // namespace gs::vrml
