#include "render/media/midi_reader.h"

#include <dlfcn.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace gs::render {
namespace {

/// Functions of FluidSynth 2 or 3, as its manual declares them. Loaded for the first MIDI file.
struct FluidSynth {
  using Settings = void;
  using Synth = void;
  using Log = void (*)(int, const char*, void*);
  Settings* (*new_fluid_settings)() = nullptr;
  void (*delete_fluid_settings)(Settings*) = nullptr;
  int (*fluid_settings_setnum)(Settings*, const char*, double) = nullptr;
  int (*fluid_settings_setint)(Settings*, const char*, int) = nullptr;
  Synth* (*new_fluid_synth)(Settings*) = nullptr;
  void (*delete_fluid_synth)(Synth*) = nullptr;
  int (*fluid_synth_sfload)(Synth*, const char*, int) = nullptr;
  int (*fluid_synth_noteon)(Synth*, int, int, int) = nullptr;
  int (*fluid_synth_noteoff)(Synth*, int, int) = nullptr;
  int (*fluid_synth_cc)(Synth*, int, int, int) = nullptr;
  int (*fluid_synth_program_change)(Synth*, int, int) = nullptr;
  int (*fluid_synth_channel_pressure)(Synth*, int, int) = nullptr;
  int (*fluid_synth_key_pressure)(Synth*, int, int, int) = nullptr;
  int (*fluid_synth_pitch_bend)(Synth*, int, int) = nullptr;
  int (*fluid_synth_system_reset)(Synth*) = nullptr;
  int (*fluid_synth_write_float)(Synth*, int, void*, int, int, void*, int, int) = nullptr;
  Log (*fluid_set_log_function)(int, Log, void*) = nullptr;
  std::string problem;

  FluidSynth() {
    void* handle = nullptr;
    for (const char* name : {"libfluidsynth.so.3", "libfluidsynth.so.2"})
      if (!handle) handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      problem = "libfluidsynth.so.3 cannot be opened (Debian package libfluidsynth3)";
      return;
    }
    const auto find = [&](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
      if (!function && problem.empty()) problem = std::string("the library has no ") + name;
    };
#define GHOSTSPACE_FLUID_FIND(name) find(name, #name);
    GHOSTSPACE_FLUID_FIND(new_fluid_settings)
    GHOSTSPACE_FLUID_FIND(delete_fluid_settings)
    GHOSTSPACE_FLUID_FIND(fluid_settings_setnum)
    GHOSTSPACE_FLUID_FIND(fluid_settings_setint)
    GHOSTSPACE_FLUID_FIND(new_fluid_synth)
    GHOSTSPACE_FLUID_FIND(delete_fluid_synth)
    GHOSTSPACE_FLUID_FIND(fluid_synth_sfload)
    GHOSTSPACE_FLUID_FIND(fluid_synth_noteon)
    GHOSTSPACE_FLUID_FIND(fluid_synth_noteoff)
    GHOSTSPACE_FLUID_FIND(fluid_synth_cc)
    GHOSTSPACE_FLUID_FIND(fluid_synth_program_change)
    GHOSTSPACE_FLUID_FIND(fluid_synth_channel_pressure)
    GHOSTSPACE_FLUID_FIND(fluid_synth_key_pressure)
    GHOSTSPACE_FLUID_FIND(fluid_synth_pitch_bend)
    GHOSTSPACE_FLUID_FIND(fluid_synth_system_reset)
    GHOSTSPACE_FLUID_FIND(fluid_synth_write_float)
    GHOSTSPACE_FLUID_FIND(fluid_set_log_function)
#undef GHOSTSPACE_FLUID_FIND
    if (!problem.empty()) return;
    constexpr int kLevels = 5;
    for (int level = 0; level < kLevels; ++level)
      (void)fluid_set_log_function(
          level, [](int, const char*, void*) {}, nullptr);
  }
};

const FluidSynth& fluid_synth() {
  static const FluidSynth library;
  return library;
}

/// Paths of General MIDI sound fonts in Debian. The first is the system's default.
constexpr std::array<const char*, 5> kSoundFonts = {
    "/usr/share/sounds/sf3/default-GM.sf3", "/usr/share/sounds/sf2/default-GM.sf2",
    "/usr/share/sounds/sf2/FluidR3_GM.sf2", "/usr/share/sounds/sf2/TimGM6mb.sf2", "/usr/share/soundfonts/default.sf2"};

class MidiReader final : public SampleReader {
 public:
  MidiReader(MidiSong song, double rate) : song_(std::move(song)), rate_(std::clamp(rate, 8000.0, 96000.0)) {}
  ~MidiReader() override {
    const FluidSynth& fluid = fluid_synth();
    if (synth_) fluid.delete_fluid_synth(synth_);
    if (settings_) fluid.delete_fluid_settings(settings_);
  }

  /// Opens synthesizer and sound font. Returns the name of the missing part, or an empty string.
  std::string open() {
    const FluidSynth& fluid = fluid_synth();
    if (!fluid.problem.empty()) return fluid.problem;
    settings_ = fluid.new_fluid_settings();
    if (!settings_) return "not enough memory";
    (void)fluid.fluid_settings_setnum(settings_, "synth.sample-rate", rate_);
    (void)fluid.fluid_settings_setnum(settings_, "synth.gain", 0.5);
    (void)fluid.fluid_settings_setint(settings_, "synth.lock-memory", 0);
    synth_ = fluid.new_fluid_synth(settings_);
    if (!synth_) return "not enough memory";
    for (const char* font : kSoundFonts) {
      struct stat status {};
      if (stat(font, &status) == 0 && fluid.fluid_synth_sfload(synth_, font, 1) >= 0) return {};
    }
    return "no sound font in /usr/share/sounds (Debian package timgm6mb-soundfont)";
  }

  [[nodiscard]] double rate() const override { return rate_; }
  [[nodiscard]] int channels() const override { return 2; }

  std::size_t read(std::span<float> to) override {
    const FluidSynth& fluid = fluid_synth();
    const auto end = static_cast<std::uint64_t>(std::ceil(song_.duration * rate_));
    std::size_t pairs = 0;
    const std::size_t wanted = to.size() / 2;
    while (pairs < wanted && at_ < end) {
      while (next_ < song_.events.size() && sample_of(song_.events[next_]) <= at_) play(song_.events[next_++], true);
      std::uint64_t until = std::min<std::uint64_t>(end, at_ + (wanted - pairs));
      if (next_ < song_.events.size()) until = std::min(until, sample_of(song_.events[next_]));
      const auto count = static_cast<std::size_t>(until - at_);
      float* const first = to.data() + 2 * pairs;
      if (fluid.fluid_synth_write_float(synth_, static_cast<int>(count), first, 0, 2, first, 1, 2) != 0) break;
      at_ = until;
      pairs += count;
    }
    return pairs;
  }

  void seek(double seconds) override {
    (void)fluid_synth().fluid_synth_system_reset(synth_);
    const double to = std::isfinite(seconds) ? std::clamp(seconds, 0.0, song_.duration) : 0;
    at_ = static_cast<std::uint64_t>(std::llround(to * rate_));
    // Send earlier settings again. Notes that began earlier remain silent.
    for (next_ = 0; next_ < song_.events.size() && sample_of(song_.events[next_]) < at_; ++next_)
      play(song_.events[next_], false);
  }

 private:
  [[nodiscard]] std::uint64_t sample_of(const MidiEvent& event) const {
    return static_cast<std::uint64_t>(std::llround(event.time * rate_));
  }

  void play(const MidiEvent& event, bool notes) {
    const FluidSynth& fluid = fluid_synth();
    const int channel = event.status & 0xf;
    switch (event.status >> 4) {
      case 0x8:
        if (notes) (void)fluid.fluid_synth_noteoff(synth_, channel, event.first);
        break;
      case 0x9:
        if (!notes) break;
        if (event.second == 0)
          (void)fluid.fluid_synth_noteoff(synth_, channel, event.first);
        else
          (void)fluid.fluid_synth_noteon(synth_, channel, event.first, event.second);
        break;
      case 0xa:
        if (notes) (void)fluid.fluid_synth_key_pressure(synth_, channel, event.first, event.second);
        break;
      case 0xb:
        (void)fluid.fluid_synth_cc(synth_, channel, event.first, event.second);
        break;
      case 0xc:
        (void)fluid.fluid_synth_program_change(synth_, channel, event.first);
        break;
      case 0xd:
        (void)fluid.fluid_synth_channel_pressure(synth_, channel, event.first);
        break;
      case 0xe:
        (void)fluid.fluid_synth_pitch_bend(synth_, channel, event.second << 7 | event.first);
        break;
      default:
        break;
    }
  }

  MidiSong song_;
  double rate_;
  FluidSynth::Settings* settings_ = nullptr;
  FluidSynth::Synth* synth_ = nullptr;
  std::size_t next_ = 0;  // index of the next event
  std::uint64_t at_ = 0;  // position in sample pairs from the start
};

}  // namespace

std::variant<std::unique_ptr<SampleReader>, MediaError> open_midi(std::span<const std::byte> bytes, double rate) {
  auto song = read_midi(bytes);
  if (auto* wrong = std::get_if<MediaError>(&song)) return std::move(*wrong);
  auto reader = std::make_unique<MidiReader>(std::move(std::get<MidiSong>(song)), rate);
  if (const std::string missing = reader->open(); !missing.empty())
    return MediaError{"MIDI needs FluidSynth and a sound font: " + missing};
  return reader;
}

}  // namespace gs::render
