#pragma once

#include "render/media/sample_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::render {

/// A message to the synthesiser.
struct MidiEvent {
  double time = 0;  // seconds from the start
  std::uint8_t status = 0, first = 0, second = 0;
};

/// The notes of a standard MIDI file (type 0 or 1).
struct MidiSong {
  std::vector<MidiEvent> events;  // in the order of time
  double duration = 0;            // in seconds, to the end of the longest track
};

/// Whether the bytes begin as a standard MIDI file.
[[nodiscard]] bool is_midi(std::span<const std::byte> bytes);
/// Reads it: up to kMostMidiEvents. Safe for untrusted bytes; a track that is cut or damaged ends there.
[[nodiscard]] std::variant<MidiSong, MediaError> read_midi(std::span<const std::byte> bytes);
inline constexpr std::size_t kMostMidiEvents = 1'000'000;
[[nodiscard]] std::variant<double, MediaError> midi_duration(std::span<const std::byte> bytes);

/// Played by FluidSynth, opened at run time, with the General MIDI sound font of the system. The error names what is
/// missing.
[[nodiscard]] std::variant<std::unique_ptr<SampleReader>, MediaError> open_midi(std::span<const std::byte> bytes,
                                                                                double rate);

}  // namespace gs::render
