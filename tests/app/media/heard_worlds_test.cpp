// Tests of the sound of whole worlds, in simulated time. The standard's formulas give levels and times.
#include "app/base/exit_status.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/simulation/simulation.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace gs::app::heard_worlds_test {
namespace {

const std::string kHeader = "#VRML V2.0 utf8\nNavigationInfo { type \"NONE\" }\n";

struct Ears {
  std::vector<float> pairs;
  [[nodiscard]] double left(double time) const { return at(time, 0); }
  [[nodiscard]] double right(double time) const { return at(time, 1); }
  [[nodiscard]] double at(double time, std::size_t channel) const {
    const std::size_t i = 2 * static_cast<std::size_t>(std::llround(time * kMixRate)) + channel;
    return i < pairs.size() ? pairs[i] : -1;
  }
};

/// Runs the world for a duration, and returns its sound.
Ears hear(const ScratchFolder& folder, const std::string& world, double seconds,
          const std::vector<InputRow>& rows = {}) {
  const std::string path = folder.write("main.wrl", kHeader + world);
  WorldLoading loading(path, {});
  LoadedWorld opened = load_world(loading, path);
  for (const Diagnostic& one : opened.diagnostics.entries()) UNSCOPED_INFO(one.text());
  CHECK(opened.diagnostics.entries().empty());
  REQUIRE(opened.scene);
  Simulation simulation(std::move(opened), {64, 48});
  simulation.fetch_with(loading);
  Diagnostics diagnostics;
  REQUIRE(simulation.plan(rows, "rows", diagnostics));
  Ears ears;
  simulation.hear(
      [&](std::span<const float> pairs) { ears.pairs.insert(ears.pairs.end(), pairs.begin(), pairs.end()); });
  simulation.run(seconds);
  CHECK(ears.pairs.size() == 2 * static_cast<std::size_t>(std::llround(seconds * kMixRate)));
  return ears;
}

InputRow set_row(double time, const std::string& node, const std::string& event, const std::string& value) {
  InputRow row;
  row.time = time;
  row.kind = InputRow::Kind::set;
  row.name = node;
  row.event = event;
  row.value = value;
  return row;
}

std::string clip(const std::string& fields = "loop TRUE", const std::string& url = "half.wav") {
  return "source DEF C AudioClip { url \"" + url + "\" " + fields + " } ";
}

const double kHalf = std::lround(0.5 * 32767) / 32768.0;

TEST_CASE("plays a Sound by intensity and distance in dB, panned by its angle (6.42, 7.3.4)") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::constant(1));
  // In front, at distance 6 between 1 and 11, the level is -10 dB. Intensity 0.75 adds -5 dB.
  Ears ears =
      hear(folder, "Viewpoint { position 0 0 6 } Sound { maxFront 11 maxBack 11 intensity 0.75 " + clip() + "}", 0.5);
  const double level = kHalf * std::pow(10, -15 / 20.0);
  for (const double time : {0.1, 0.4}) {
    CHECK(ears.left(time) == Approx(level * 0.75).margin(1e-3));
    CHECK(ears.right(time) == Approx(level * 0.75).margin(1e-3));
  }
  // The sound is on the right, so the pan is 1.
  ears = hear(folder,
              "Viewpoint { } Transform { translation 6 0 10 children Sound { maxFront 11 maxBack 11 " + clip() + "} }",
              0.2);
  CHECK(ears.left(0.1) == Approx(0).margin(1e-3));
  CHECK(ears.right(0.1) == Approx(kHalf * std::pow(10, -0.5)).margin(1e-3));
  // A sound that is not spatialized, and a sound out of range.
  ears = hear(folder,
              "Viewpoint { } Sound { location 6 0 10 spatialize FALSE maxFront 11 maxBack 11 " + clip() + "} " +
                  "Sound { location 0 0 -2 source USE C }",
              0.2);
  CHECK(ears.left(0.1) == Approx(kHalf * std::pow(10, -0.5)).margin(1e-3));
  CHECK(ears.right(0.1) == ears.left(0.1));
}

TEST_CASE("moves a Sound with its Transform and the viewer, without steps (6.42)") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::constant(1));
  const Ears ears = hear(folder,
                         "Viewpoint { } DEF V2 Viewpoint { position 0 0 8 } DEF T Transform { translation 0 0 2 "
                         "children Sound { spatialize FALSE maxFront 11 maxBack 11 " +
                             clip() + "} }",
                         1.5, {set_row(0.5, "T", "translation", "0 0 6"), [] {
                                 InputRow row;
                                 row.time = 1;
                                 row.kind = InputRow::Kind::viewpoint;
                                 row.name = "V2";
                                 return row;
                               }()});
  const auto level = [](double distance) { return kHalf * std::pow(10, -(distance - 1) / 10); };
  CHECK(ears.left(0.4) == Approx(level(8)).margin(1e-3));
  CHECK(ears.left(0.9) == Approx(level(4)).margin(1e-3));
  CHECK(ears.left(1.4) == Approx(level(2)).margin(1e-3));
  float steepest = 0;
  for (std::size_t i = 1; i < ears.pairs.size() / 2; ++i)
    steepest = std::max(steepest, std::abs(ears.pairs[2 * i] - ears.pairs[2 * i - 2]));
  CHECK(steepest < 0.11f);  // only at the beginning of the sound
}

TEST_CASE("mutes a Sound that a Switch hides, and resumes it in world time (6.42)") {
  const ScratchFolder folder;
  (void)folder.write("ramp.wav", media::wav(48'000, 1, 96'000, [](std::size_t i, int) { return i / 96'000.0; }));
  const std::string sound =
      "Sound { spatialize FALSE minFront 20 minBack 20 " + clip("startTime 946684800", "ramp.wav") + "}";
  const Ears ears = hear(folder, "DEF S Switch { whichChoice 0 choice [ " + sound + " Group { } ] }", 1.5,
                         {set_row(0.5, "S", "whichChoice", "1"), set_row(1, "S", "whichChoice", "0")});
  CHECK(ears.left(0.25) == Approx(0.125).margin(2e-3));
  CHECK(ears.left(0.75) == 0);
  CHECK(ears.left(1.25) == Approx(0.625).margin(2e-3));
}

TEST_CASE("plays an AudioClip from startTime to stopTime, and again in each loop (4.6.9, 6.4)") {
  const ScratchFolder folder;
  (void)folder.write("ramp.wav", media::wav(8000, 1, 4000, [](std::size_t i, int) { return i / 4000.0; }));
  const std::string near = "Sound { spatialize FALSE minFront 20 minBack 20 ";
  Ears ears = hear(folder, near + clip("startTime 946684800.25", "ramp.wav") + "}", 1.5);
  CHECK(ears.left(0.2) == 0);
  CHECK(ears.left(0.5) == Approx(0.5).margin(2e-3));
  CHECK(ears.left(0.9) == 0);
  ears = hear(folder, near + clip("startTime 946684000.1 loop TRUE stopTime 946684801.05", "ramp.wav") + "}", 1.5);
  for (const double time : {0.3, 0.9, 1.04})
    CHECK(ears.left(time) == Approx(std::fmod(799.9 + time, 0.5) * 2).margin(4e-3));
  CHECK(ears.left(1.06) == 0);
  ears = hear(folder, near + clip("pitch 0.5 startTime 946684800", "ramp.wav") + "}", 1.5);
  CHECK(ears.left(0.5) == Approx(0.5).margin(2e-3));
  CHECK(ears.left(1.1) == 0);
}

TEST_CASE("plays a click shorter than a step completely, from its first sample") {
  const ScratchFolder folder;
  (void)folder.write("click.wav", media::constant(0.004));
  const Ears ears = hear(folder,
                         "DEF T TimeSensor { } Sound { spatialize FALSE minFront 20 minBack 20 " +
                             clip("startTime 946684800.30303", "click.wav") + "}",
                         0.5);
  std::size_t first = 0, count = 0;
  for (std::size_t i = 0; i < ears.pairs.size() / 2; ++i) {
    if (ears.pairs[2 * i] == 0) continue;
    if (count++ == 0) first = i;
  }
  CHECK(count == Approx(192).margin(1));
  CHECK(static_cast<double>(first) / kMixRate == Approx(0.30303).margin(3e-5));
}

TEST_CASE("plays two sounds, stereo channels, and sounds in a PROTO and an Inline") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::constant(1));
  (void)folder.write("stereo.wav",
                     media::wav(48'000, 2, 48'000, [](std::size_t, int c) { return c == 0 ? 0.1 : 0.3; }));
  (void)folder.write("inner.wrl", kHeader + "Sound { spatialize FALSE minFront 20 minBack 20 " +
                                      clip("loop TRUE", "stereo.wav") + "}");
  const Ears ears = hear(folder,
                         "PROTO P [ field MFString url [ ] ] { Sound { spatialize FALSE minFront 20 minBack 20 source "
                         "AudioClip { loop TRUE url IS url } } } P { url \"half.wav\" } Inline { url \"inner.wrl\" }",
                         0.3);
  CHECK(ears.left(0.2) == Approx(0.6).margin(1e-3));
  CHECK(ears.right(0.2) == Approx(0.8).margin(1e-3));
}

TEST_CASE("chooses by priority if more sounds are active than can be played (7.3.4.1)") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::constant(1, 0.01));
  (void)folder.write("other.wav", media::constant(1, 0.5));
  std::string world;
  for (std::size_t i = 0; i < kMaxVoices + 8; ++i)
    world += "Sound { spatialize FALSE minFront 20 minBack 20 " + clip() + "} ";
  world += "Sound { priority 1 intensity 0.5 spatialize FALSE minFront 20 minBack 20 " +
           clip("loop TRUE", "other.wav") + "}";
  const Ears ears = hear(folder, world, 0.2);
  CHECK(ears.left(0.1) == Approx(0.5 * std::pow(10, -0.5) + 0.01 * (kMaxVoices - 1)).margin(2e-3));
}

TEST_CASE("plays a movie as source of a Sound (6.28)") {
  const ScratchFolder folder;
  (void)folder.write("tone.mpg",
                     media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/sound/tone.mpg"));
  const Ears ears = hear(folder,
                         "Sound { spatialize FALSE minFront 20 minBack 20 source MovieTexture { url \"tone.mpg\" "
                         "startTime 946684800 } }",
                         1.5);
  double squares = 0;
  int crossings = 0;
  for (std::size_t i = 24'000; i < 67'200; ++i) {
    squares += ears.pairs[2 * i] * ears.pairs[2 * i];
    if (ears.pairs[2 * i] < 0 && ears.pairs[2 * i + 2] >= 0) ++crossings;
  }
  CHECK(std::sqrt(squares / 43'200) == Approx(0.5 / std::sqrt(2.0)).margin(0.03));
  CHECK(crossings / 0.9 == Approx(440).margin(3));
}

TEST_CASE("mixes the same world to the same samples") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::tone(0.7, 300, 0.5, 22'050));
  const std::string world = "DEF T Transform { children Sound { " + clip("pitch 1.3 loop TRUE") + "} }";
  const std::vector<InputRow> rows = {set_row(0.3, "T", "translation", "2 0 3")};
  CHECK(hear(folder, world, 0.6, rows).pairs == hear(folder, world, 0.6, rows).pairs);
}

TEST_CASE("trace --sound and --snapshot --sound write a WAV, and overwrite only a WAV") {
  const ScratchFolder folder;
  (void)folder.write("half.wav", media::constant(0.5));
  const std::string world = folder.write(
      "main.wrl", kHeader + "Sound { spatialize FALSE minFront 20 minBack 20 " + clip("startTime 946684800") + "}");
  const std::string out = folder.write("out.wav", "");
  const Run traced = run("trace " + quoted(world) + " --until 1 --sound " + quoted(out));
  CHECK(traced.status == kDone);
  CHECK(traced.output.find("946684800 C.duration_changed 0.5\n") != std::string::npos);
  CHECK(traced.output.find("946684800 C.isActive TRUE\n") != std::string::npos);
  CHECK(traced.output.find("C.isActive FALSE\n") != std::string::npos);
  const std::vector<float> samples = media::samples_of(folder.read("out.wav"));
  REQUIRE(samples.size() == 2 * 48'000);
  CHECK(samples[2 * 12'000] == Approx(0.5).margin(1e-3));
  CHECK(samples[2 * 36'000] == 0);
  const std::string text = folder.write("text.wav", "not a sound");
  CHECK(run("trace " + quoted(world) + " --until 1 --sound " + quoted(text)).status == kFailed);
  CHECK(folder.read("text.wav") == "not a sound");
  CHECK(run("trace " + quoted(world) + " --until 1 --sound /nowhere/out.wav").status == kNotWritten);
}

}  // namespace
}  // namespace gs::app::heard_worlds_test
