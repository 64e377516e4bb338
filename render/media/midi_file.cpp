#include "render/media/midi_reader.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <string_view>

// Reader of standard MIDI files. A file has chunks (4 letters, length, data). Tracks have messages with time
// differences.
namespace gs::render {
namespace {

using namespace std::string_view_literals;

constexpr double kLongestSong = 1e6;  // maximum seconds of a song

struct Cursor {
  std::span<const std::byte> bytes;
  std::size_t at = 0;
  bool over = false;  // the data ended too early

  std::uint8_t byte() {
    if (at >= bytes.size()) {
      over = true;
      return 0;
    }
    return std::to_integer<std::uint8_t>(bytes[at++]);
  }
  std::uint32_t number(int count) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | byte();
    return value;
  }
  // Reads a variable-length number: 7 bits per byte, at most 4 bytes.
  std::uint32_t length() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) {
      const std::uint8_t next = byte();
      value = value << 7 | (next & 0x7fu);
      if (next < 0x80) return value;
    }
    over = true;
    return value;
  }
  std::span<const std::byte> take(std::size_t count) {
    const std::size_t there = std::min(count, bytes.size() - at);
    if (there < count) over = true;
    const auto result = bytes.subspan(at, there);
    at += there;
    return result;
  }
};

struct Timed {
  std::uint64_t tick;
  std::uint32_t order;
  std::uint32_t tempo;  // microseconds per quarter note, for a change of tempo; 0 for a message
  MidiEvent event;
};

// Reads a track and appends its events. Returns false if there are too many events.
bool read_track(std::span<const std::byte> bytes, std::vector<Timed>& events, std::uint64_t& last) {
  Cursor at{bytes};
  std::uint64_t tick = 0;
  std::uint8_t running = 0;
  while (at.at < bytes.size()) {
    tick += at.length();
    std::uint8_t status = at.byte();
    if (at.over) break;
    if (status < 0x80) {
      if (running == 0) break;
      status = running;
      --at.at;
    }
    if (status == 0xff) {
      const std::uint8_t kind = at.byte();
      Cursor data{at.take(at.length())};
      if (at.over) break;
      last = std::max(last, tick);
      if (kind == 0x2f) break;
      if (kind == 0x51 && data.bytes.size() == 3) {
        const std::uint32_t tempo = data.number(3);
        if (tempo > 0) events.push_back({tick, static_cast<std::uint32_t>(events.size()), tempo, {}});
      }
    } else if (status >= 0xf0) {
      (void)at.take(at.length());
    } else {
      running = status;
      MidiEvent event;
      event.status = status;
      event.first = at.byte() & 0x7fu;
      const std::uint8_t kind = status >> 4;
      if (kind != 0xc && kind != 0xd) event.second = at.byte() & 0x7fu;
      if (at.over) break;
      last = std::max(last, tick);
      events.push_back({tick, static_cast<std::uint32_t>(events.size()), 0, event});
    }
    if (at.over || events.size() > kMaxMidiEvents) break;
  }
  return events.size() <= kMaxMidiEvents;
}

}  // namespace

bool is_midi(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "MThd", 4) == 0;
}

std::variant<MidiSong, MediaError> read_midi(std::span<const std::byte> bytes) {
  const auto wrong = [](const std::string& what) { return MediaError{"broken MIDI: " + what}; };
  if (!is_midi(bytes)) return wrong("expected MThd");
  Cursor at{bytes, 4};
  const std::uint32_t header = at.number(4);
  const std::uint32_t type = at.number(2);
  (void)at.number(2);  // declared number of tracks; unused, because the chunks are counted
  const std::uint32_t division = at.number(2);
  if (at.over || header < 6) return wrong("expected a header of 6 bytes");
  if (type > 1) return wrong("expected type 0 or 1, found " + std::to_string(type));
  (void)at.take(header - 6);
  // `division` is ticks per quarter note, or negative frames per second and ticks per frame.
  const double frames = 256.0 - (division >> 8), ticks = division & 0xff;
  const bool by_frames = (division & 0x8000) != 0;
  if (division == 0 || (by_frames && ticks == 0)) return wrong("expected a division of time");
  std::vector<Timed> events;
  std::uint64_t last = 0;
  while (at.at < bytes.size() && !at.over) {
    const std::uint32_t kind = at.number(4);
    const std::uint32_t length = at.number(4);
    if (at.over) break;
    const auto track = at.take(length);
    if (kind == 0x4d54726b && !read_track(track, events, last))  // MTrk
      return wrong("more than " + std::to_string(kMaxMidiEvents) + " events");
  }
  std::sort(events.begin(), events.end(),
            [](const Timed& a, const Timed& b) { return a.tick != b.tick ? a.tick < b.tick : a.order < b.order; });
  MidiSong song;
  double seconds = 0, a_tick = by_frames ? 1 / (frames * ticks) : 0.5 / division;
  std::uint64_t before = 0;
  for (const Timed& one : events) {
    seconds += static_cast<double>(one.tick - before) * a_tick;
    before = one.tick;
    if (!(seconds <= kLongestSong))
      return wrong("it is longer than " + std::to_string(static_cast<int>(kLongestSong)) + " s");
    if (one.tempo > 0) {
      if (!by_frames) a_tick = one.tempo * 1e-6 / division;
      continue;
    }
    song.events.push_back(one.event);
    song.events.back().time = seconds;
  }
  seconds += static_cast<double>(last - before) * a_tick;
  if (song.events.empty()) return wrong("it has no notes");
  if (!(seconds <= kLongestSong))
    return wrong("it is longer than " + std::to_string(static_cast<int>(kLongestSong)) + " s");
  song.duration = seconds;
  return song;
}

std::variant<double, MediaError> midi_duration(std::span<const std::byte> bytes) {
  auto song = read_midi(bytes);
  if (auto* wrong = std::get_if<MediaError>(&song)) return std::move(*wrong);
  return std::get<MidiSong>(song).duration;
}

}  // namespace gs::render
