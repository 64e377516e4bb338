#include "qnv/codecs/gaussians/splat_steps.h"

#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/splat_code.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/qnv/pinned_vectors.h"
#include "tests/qnv/splat_clouds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv::splat_steps_test {
namespace {

using gaussians::FineBits;
using gaussians::GapCell;
using gaussians::Precision;
using gaussians::SplatCode;
using gaussians::SplatErrors;
using gaussians::SplatLook;
using gaussians::SplatNode;
using gaussians::SplatSteps;
using Version = GaussianCoding::Version;

Gaussians gaussians_in(std::span<const std::byte> bytes) {
  StreamDecoder decoder;
  (void)decoder.push(bytes);
  Geometry geometry = decoder.geometry();
  REQUIRE(geometry.as<Gaussians>());
  return std::move(*geometry.as<Gaussians>());
}

Precision tuned(int steps, int important = 500, int finest = 200) {
  Precision precision;
  precision.important = important;
  precision.finest = finest;
  precision.steps = steps;
  precision.version = Version::tuned;
  return precision;
}

/// Returns the codes of a leaf with the given deviations, largest first, and opacity.
SplatCode code_of_leaf(const std::array<double, 3>& scales, double opacity, const Precision& precision) {
  SplatCode code;
  code.leaf = true;
  for (std::size_t k = 0; k < 3; ++k) code.scales[k] = gaussians::scale_code(scales[k]);
  code.opacity = gaussians::opacity_code(opacity);
  code.scales[2] = gaussians::thinned(code.scales[1], code.scales[2], true);
  code.fine = gaussians::fine_codes(code, scales, opacity, precision);
  return code;
}

SplatLook decoded_look(const SplatCode& code, const Precision& precision) {
  SplatNode node;
  node.leaf = code.leaf;
  for (std::size_t k = 0; k < 3; ++k) node.scales[k] = static_cast<std::int16_t>(code.scales[k]);
  for (std::size_t k = 0; k < 4; ++k) node.fine[k] = static_cast<std::uint8_t>(code.fine[k]);
  node.opacity = static_cast<std::uint8_t>(code.opacity);
  return gaussians::look_of(node, precision);
}

}  // namespace

// Earlier encoders once wrote gaussians_cloud.qnv, _part, _coarse, _trained and _tuned in tests/qnv/vectors/v1: three
// plain streams, a trained and a tuned one. gaussians_decode.py, written from FORMAT.md alone, made the .txt files.
// Never regenerate any.
TEST_CASE("decodes pinned streams of Gaussians bit for bit") {
  for (const std::string name :
       {"gaussians_cloud", "gaussians_part", "gaussians_coarse", "gaussians_trained", "gaussians_tuned"}) {
    INFO(name);
    const auto bytes = read_bytes(name + ".qnv");
    const Gaussians found = gaussians_in(bytes);
    const bool is_tuned = name == "gaussians_tuned";
    const std::size_t per = harmonic_count(found.degree);
    std::string text;
    const auto put = [&text](float number) {
      char word[16];
      std::snprintf(word, sizeof word, " %08x", static_cast<unsigned>(std::bit_cast<std::uint32_t>(number + 0.0f)));
      text += word;
    };
    std::istringstream expected(read_text(name + ".txt"));
    std::size_t i = 0;
    bool same_looks = true;
    for (std::string line; std::getline(expected, line); ++i) {
      REQUIRE(i < found.size());
      text.clear();
      std::istringstream words(line);
      for (int k = 0; k < 4; ++k) {
        double number = 0;
        words >> number;
        const double own = k < 3 ? found.scales[i][k] : found.opacities[i];
        // Tuned streams have values instead of codes here.
        const double code = k < 3 ? gaussians::scale_code(own) : gaussians::opacity_code(own);
        same_looks = same_looks && (is_tuned ? std::abs(own / number - 1) < 1e-6 : code == number);
      }
      int leaf = 0;  // whether the Gaussian is final
      words >> leaf;
      for (int k = 0; k < 4; ++k) put(found.rotations[i][k]);
      for (int k = 0; k < 3; ++k) put(found.positions[i][k]);
      for (int k = 0; k < 3; ++k) put(found.bases[i][k]);
      for (std::size_t k = 0; k < per; ++k)
        for (int c = 0; c < 3; ++c) put(found.harmonics[i * per + k][c]);
      std::string rest;
      std::getline(words, rest);
      CHECK(rest == text);
    }
    CHECK(same_looks);
    CHECK(i == found.size());
  }
}

TEST_CASE("every gap between scales lies in its cell") {
  int index = -1;
  for (int gap = 0; gap <= gaussians::kMostScale; ++gap) {
    const GapCell cell = gaussians::cell_of_gap(gap);
    CHECK(cell.lower <= gap);
    CHECK(gap < cell.lower + cell.width);
    CHECK(gaussians::cell_index(cell.middle()) == gaussians::cell_index(gap));
    const int own = gaussians::cell_index(gap);
    CHECK((own == index || own == index + 1));
    index = own;
  }
  CHECK(gaussians::thinned(300, 288, true) == 300 - 14);
  CHECK(gaussians::thinned(300, 288, false) == 300 - 14);
  CHECK(gaussians::thinned(300, 300, true) == 300);
  CHECK(gaussians::thinned(4, 0, true) >= 0);
}

TEST_CASE("fine bits bring deviations and opacities of leaves within the stated errors") {
  std::mt19937 random(7);
  const auto number = [&](double least, double most) {
    return least + (most - least) * static_cast<double>(random()) / 4294967295.0;
  };
  for (const int steps : {8, 0, -16, -32}) {
    const SplatErrors errors = gaussians::splat_errors(steps);
    const Precision precision = tuned(steps);
    double most_wide = 0, most_thin = 0, most_opacity = 0;
    for (int i = 0; i < 4000; ++i) {
      std::array<double, 3> scales{std::exp2(number(-12, 0)), std::exp2(number(-12, 0)), std::exp2(number(-20, 0))};
      std::ranges::sort(scales, std::ranges::greater{});
      const double opacity = number(0.01, 1);
      const SplatLook look = decoded_look(code_of_leaf(scales, opacity, precision), precision);
      const auto error = [&](std::size_t k) { return std::exp(std::abs(std::log(look.scales[k] / scales[k]))) - 1; };
      most_wide = std::max({most_wide, error(0), error(1)});
      most_thin = std::max(most_thin, error(2));
      most_opacity = std::max(most_opacity, std::abs(look.opacity - opacity));
    }
    CHECK(most_wide <= errors.scale[1] + 1e-9);
    CHECK(most_wide > errors.scale[1] / 2);
    CHECK(most_thin <= errors.thin[1] + 1e-9);
    CHECK(most_opacity <= errors.opacity[1] + 1e-9);
  }
}

TEST_CASE("less important leaves have larger steps") {
  const Precision precision = tuned(0);
  SplatCode code;
  code.leaf = true;
  code.opacity = 63;
  code.scales = {250, 250, 250};
  const SplatSteps usual = gaussians::steps_of(code, precision);
  // A quarter of the area: one octave of each scale.
  code.scales = {242, 242, 242};
  const SplatSteps small = gaussians::steps_of(code, precision);
  CHECK(small.color == Approx(2 * usual.color));
  CHECK(small.place[0] == Approx(usual.place[0]));  // half the deviation, twice the share
  code.scales = {258, 258, 258};
  CHECK(gaussians::steps_of(code, precision).color == Approx(usual.color / 2));
  // Limits: half and four times the usual steps.
  code.scales = {400, 400, 400};
  CHECK(gaussians::steps_of(code, precision).color == Approx(usual.color / 2));
  code.scales = {150, 150, 150};
  CHECK(gaussians::steps_of(code, precision).color == Approx(4 * usual.color));
  // Deviations below a pixel count as one pixel.
  code.scales = {100, 100, 100};
  CHECK(gaussians::importance(code.scales, 63, precision) == gaussians::importance({220, 220, 220}, 63, precision));
  // Finer steps of a stream apply only to leaves.
  code.scales = {250, 250, 250};
  CHECK(gaussians::steps_of(code, tuned(-16)).color == Approx(usual.color / 4));
  code.leaf = false;
  CHECK(gaussians::steps_of(code, tuned(-16)).color == gaussians::steps_of(code, precision).color);
  CHECK(gaussians::steps_of(code, tuned(8)).color == Approx(2 * gaussians::steps_of(code, precision).color));
}

TEST_CASE("errors of all versions are stated") {
  GaussianCoding coding;
  CHECK(gaussians::splat_errors(coding).place[0] == Approx(0.05));
  CHECK(gaussians::splat_errors(coding).place[1] == Approx(0.1));
  CHECK(gaussians::splat_errors(coding).color[1] == Approx(6.0 / 128));
  coding.version = Version::trained;
  coding.fine = 1;
  CHECK(gaussians::splat_errors(coding).color[1] == Approx(3.0 / 90));
  CHECK(gaussians::splat_errors(coding).opacity[0] == Approx(0.5 / 63));
  coding = {};
  coding.version = Version::tuned;
  const SplatErrors errors = gaussians::splat_errors(coding);
  CHECK(errors.place[1] == Approx(4 * errors.place[0]));
  CHECK(errors.thin[1] == Approx(std::sqrt(2.0) - 1));
  CHECK(gaussians::splat_errors(-8).place[0] == Approx(errors.place[0] / 2));
}

}  // namespace gs::qnv::splat_steps_test
