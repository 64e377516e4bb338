#pragma once

#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::render {

/// Timed message to the synthesizer.
struct MidiEvent {
  double time = 0;  // seconds from the start
  std::uint8_t status = 0, first = 0, second = 0;
};

/// Events of a standard MIDI file (type 0 or 1).
struct MidiSong {
  std::vector<MidiEvent> events;  // in order of time
  double duration = 0;            // seconds to the end of the longest track
};

/// Reports whether the bytes begin like a standard MIDI file.
[[nodiscard]] bool is_midi(std::span<const std::byte> bytes);
/// Reads a MIDI file, up to kMaxMidiEvents events. A truncated or damaged track ends at the damage. Safe for untrusted
/// bytes.
[[nodiscard]] std::variant<MidiSong, MediaError> read_midi(std::span<const std::byte> bytes);
inline constexpr std::size_t kMaxMidiEvents = 1'000'000;
[[nodiscard]] std::variant<double, MediaError> midi_duration(std::span<const std::byte> bytes);

/// Opens a player for a MIDI file. Uses FluidSynth, loaded at run time, and the system's General MIDI sound font. The
/// error names the missing part.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_midi(std::span<const std::byte> bytes,
                                                                                double rate);

}  // namespace gs::render
