#pragma once

#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::render {

/// Message to the synthesizer.
struct MidiEvent {
  double time = 0;  // seconds from the start
  std::uint8_t status = 0, first = 0, second = 0;
};

/// Notes of a standard MIDI file (type 0 or 1).
struct MidiSong {
  std::vector<MidiEvent> events;  // in order of time
  double duration = 0;            // seconds to the end of the longest track
};

/// Reports whether the bytes start like a standard MIDI file.
[[nodiscard]] bool is_midi(std::span<const std::byte> bytes);
/// Reads up to kMaxMidiEvents events. Accepts untrusted input; a truncated or damaged track ends there.
[[nodiscard]] std::variant<MidiSong, MediaError> read_midi(std::span<const std::byte> bytes);
inline constexpr std::size_t kMaxMidiEvents = 1'000'000;
[[nodiscard]] std::variant<double, MediaError> midi_duration(std::span<const std::byte> bytes);

/// Plays a MIDI file with FluidSynth, opened at run time, and the system's General MIDI sound font. The error names the
/// missing part.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_midi(std::span<const std::byte> bytes,
                                                                                double rate);

}  // namespace gs::render
