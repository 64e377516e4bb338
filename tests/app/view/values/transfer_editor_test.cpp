#include "app/view/values/transfer_editor.h"

#include "render/scene/splat_style.h"
#include "render/volume/volume_model.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace gs;
using namespace gs::app;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Transfer ramp() { return {{0.2f, {0, 0, 0}, 0}, {0.6f, {200, 100, 50}, 0.8f}, {1, {255, 255, 255}, 0.4f}}; }

void check_transfer(const Transfer& transfer) {
  REQUIRE_FALSE(transfer.empty());
  REQUIRE(transfer.size() <= kMaxTransferPoints);
  for (std::size_t i = 0; i < transfer.size(); ++i) {
    const qnv::TransferPoint& p = transfer[i];
    REQUIRE((p.value >= 0 && p.value <= 1 && p.opacity >= 0 && p.opacity <= 1));
    REQUIRE((i == 0 || transfer[i - 1].value <= p.value));
  }
}

Box box(const glm::vec3& lower, const glm::vec3& upper) {
  Box bounds;
  bounds.add(lower);
  bounds.add(upper);
  return bounds;
}
float side(const glm::vec4& plane, const glm::vec3& p) { return glm::dot(glm::vec3(plane), p) + plane.w; }

TEST_CASE("stretches a transfer function to a range of values") {
  Transfer transfer{{0.2f, {}, 0}, {0.4f, {}, 0.5f}, {0.6f, {}, 1}};
  CHECK(stretch(transfer, 0.1f, 0.9f));
  CHECK(transfer[0].value == Approx(0.1f));
  CHECK(transfer[1].value == Approx(0.5f));
  CHECK(transfer[2].value == Approx(0.9f));
  const Transfer before = transfer;
  CHECK(stretch(transfer, 0.1f, 0.9f));
  CHECK(transfer[1].value == Approx(before[1].value));
  CHECK_FALSE(stretch(transfer, 0.5f, 0.5f));
  Transfer flat{{0.3f, {}, 0}, {0.3f, {}, 1}}, none;
  CHECK_FALSE(stretch(flat, 0, 1));
  CHECK_FALSE(stretch(none, 0, 1));
}

}  // namespace

TEST_CASE("interpolates transfer functions linearly, and extends them constantly") {
  const Transfer transfer = ramp();
  CHECK(transfer_at(transfer, 0.1f).opacity == 0);
  CHECK(transfer_at(transfer, 0.4f).opacity == Approx(0.4));
  CHECK(transfer_at(transfer, 0.4f).color == qnv::Rgb8{100, 50, 25});
  CHECK(transfer_at(transfer, 0.8f).opacity == Approx(0.6));
  CHECK(transfer_at(transfer, 0.6f).color == qnv::Rgb8{200, 100, 50});
  CHECK(transfer_at(transfer, 7).opacity == Approx(0.4));
  CHECK(transfer_at({}, 0.5f).opacity == 0);
  CHECK(transfer_at(transfer, kNaN).opacity == 0);
}

TEST_CASE("shows in the editor the colours that the renderer draws") {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> part(0, 1);
  for (int round = 0; round < 50; ++round) {
    Transfer transfer;
    for (int i = 0; i < 6; ++i)
      transfer.push_back({i == 3 ? transfer.back().value : part(random),
                          {static_cast<std::uint8_t>(random() % 256), static_cast<std::uint8_t>(random() % 256), 7},
                          part(random)});
    transfer = sound_transfer(transfer);
    const render::VolumeTransfer table = render::volume_transfer({}, transfer);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const qnv::TransferPoint at = transfer_at(transfer, static_cast<float>(i) / 255);
      REQUIRE_EACH(1 - std::exp(-table[i].w) == Approx(std::min(at.opacity, 0.999f)).margin(1e-4));
      REQUIRE_EACH(table[i].x * 255 == Approx(static_cast<float>(at.color.r)).margin(0.51));
    }
  }
}

TEST_CASE("adds points on the curve under the pointer, in its colour") {
  Transfer transfer = ramp();
  const auto index = add_point(transfer, 0.4f, 0.9f);
  REQUIRE(index);
  CHECK(*index == 1);
  CHECK(transfer.size() == 4);
  CHECK(transfer[1] == qnv::TransferPoint{0.4f, {100, 50, 25}, 0.9f});
  CHECK(*add_point(transfer, -3, 4) == 0);
  CHECK(transfer[0].value == 0);
  CHECK(transfer[0].opacity == 1);
  const auto last = add_point(transfer, 3, -4);
  CHECK(*last == transfer.size() - 1);
  check_transfer(transfer);
  while (transfer.size() < kMaxTransferPoints) REQUIRE(add_point(transfer, 0.5f, 0.5f));
  CHECK_FALSE(add_point(transfer, 0.5f, 0.5f));
  CHECK(transfer.size() == kMaxTransferPoints);
  check_transfer(transfer);
}

TEST_CASE("moves points between their neighbours") {
  Transfer transfer = ramp();
  move_point(transfer, 1, 0.7f, 0.3f);
  CHECK(transfer[1] == qnv::TransferPoint{0.7f, {200, 100, 50}, 0.3f});
  move_point(transfer, 1, 0.05f, 2);
  CHECK(transfer[1].value == 0.2f);
  CHECK(transfer[1].opacity == 1);
  move_point(transfer, 1, 5, -1);
  CHECK(transfer[1].value == 1);
  CHECK(transfer[1].opacity == 0);
  move_point(transfer, 0, -5, 0.5f);
  CHECK(transfer[0].value == 0);
  move_point(transfer, 2, kNaN, kNaN);
  move_point(transfer, 3, 0.5f, 0.5f);
  check_transfer(transfer);
}

TEST_CASE("removes all points but the last one") {
  Transfer transfer = ramp();
  CHECK_FALSE(remove_point(transfer, 3));
  CHECK(remove_point(transfer, 1));
  CHECK(transfer.back().value == 1);
  CHECK(remove_point(transfer, 0));
  CHECK_FALSE(remove_point(transfer, 0));
  CHECK(transfer.size() == 1);
}

TEST_CASE("keeps a transfer function valid under any edits") {
  std::mt19937 random(1);
  const float values[] = {-1, 0, 0.3f, 0.30001f, 0.9f, 1, 2, kNaN, kInfinity, -kInfinity};
  const auto any = [&] { return values[random() % std::size(values)]; };
  Transfer transfer{{0, {}, 0}};
  for (int i = 0; i < 5000; ++i) {
    const std::size_t index = random() % (transfer.size() + 1);
    switch (random() % 5) {
      case 0:
        (void)remove_point(transfer, index);
        break;
      case 1:
      case 2:
        (void)add_point(transfer, any(), any());
        break;
      default:
        move_point(transfer, index, any(), any());
    }
    check_transfer(transfer);
  }
}

TEST_CASE("corrects invalid transfer functions of files") {
  check_transfer(sound_transfer({}));
  const Transfer sorted =
      sound_transfer({{0.9f, {1, 1, 1}, 7}, {kNaN, {}, 0}, {-2, {2, 2, 2}, -1}, {0.5f, {3, 3, 3}, kInfinity}});
  REQUIRE(sorted.size() == 2);
  CHECK(sorted[0] == qnv::TransferPoint{0, {2, 2, 2}, 0});
  CHECK(sorted[1] == qnv::TransferPoint{0.9f, {1, 1, 1}, 1});
  CHECK(sound_transfer(ramp()) == ramp());
  Transfer many;
  for (int i = 0; i <= 1000; ++i) many.push_back({static_cast<float>(i) / 1000, {}, static_cast<float>(i) / 1000});
  const Transfer fewer = sound_transfer(many);
  check_transfer(fewer);
  CHECK(transfer_at(fewer, 0.123f).opacity == Approx(0.123).margin(0.001));
  qnv::Description volume;
  volume.value_range = {0, 100};
  check_transfer(own_transfer(volume));
  volume.transfer = ramp();
  CHECK(own_transfer(volume) == ramp());
}

TEST_CASE("offers valid presets in any range, and in Hounsfield units") {
  for (const TransferPreset& preset : transfer_presets())
    for (const auto& range : {std::pair{0.0f, 1.0f},
                              {-1024.0f, 3071.0f},
                              {0.0f, 3272.0f},
                              {5.0f, 5.0f},
                              {kNaN, kNaN},
                              {-kInfinity, kInfinity},
                              {3e38f, -3e38f}}) {
      const Transfer transfer = preset.make(range);
      check_transfer(transfer);
      CHECK(sound_transfer(transfer) == transfer);
    }
  const Transfer bone = transfer_presets()[0].make({-1000, 3000});
  CHECK(transfer_at(bone, 0.25f).opacity == 0);             // water
  CHECK(transfer_at(bone, 1600 / 4000.0f).opacity > 0.8f);  // 600 Hounsfield units
  CHECK(transfer_at(transfer_presets()[0].make({0, 4000}), 1600 / 4000.0f).opacity ==
        Approx(transfer_at(bone, 1600 / 4000.0f).opacity));  // the same with 1000 added
}

TEST_CASE("summarises volumes by class and magnitude") {
  auto first = std::make_shared<qnv::Volume>(), second = std::make_shared<qnv::Volume>();
  for (const float weight : {4.0f, 3.0f, 2.0f, kNaN, 0.0f}) {
    first->weights.push_back(weight);
    first->classes.push_back(weight == 4 ? 10 : 20);
  }
  second->weights = {1};
  second->classes = {30};
  const std::vector<std::shared_ptr<const qnv::Volume>> volumes{first, nullptr, second};
  const VolumeSummary summary = summarize(volumes);
  CHECK(summary.classes[20] == 1);  // 3 + 2
  CHECK(summary.classes[10] == Approx(0.8));
  CHECK(summary.classes[30] == Approx(0.2));
  CHECK(summary.magnitudes == std::vector<float>{1, 2, 3, 4});
  CHECK(share_left(summary, 0) == 1);
  CHECK(share_left(summary, 2) == 0.75f);
  CHECK(share_left(summary, 2.5f) == 0.5f);
  CHECK(share_left(summary, 5) == 0);
  CHECK(share_left({}, 1) == 0);
  CHECK(summarize({}).largest() == 0);
}

TEST_CASE("estimates the magnitudes of many vectors from a sample of all") {
  auto geometry = std::make_shared<qnv::Volume>();
  for (int i = 0; i < 300000; ++i) geometry->weights.push_back(static_cast<float>(i + 1));
  const std::vector<std::shared_ptr<const qnv::Volume>> volumes{geometry};
  const VolumeSummary summary = summarize(volumes);
  CHECK(summary.magnitudes.size() <= 65536);
  CHECK(share_left(summary, 100000) == Approx(2 / 3.0).margin(0.001));
}

TEST_CASE("maps sliders proportionally and back") {
  const LogScale scale{0.1f, 10, true};
  CHECK(scale.value_at(0) == 0);
  CHECK(scale.value_at(0.5f) == Approx(1));
  CHECK(scale.value_at(1) == Approx(10));
  CHECK(scale.value_at(9) == Approx(10));
  CHECK(scale.value_at(kNaN) == 0);
  for (const float place : {0.0f, 0.1f, 0.5f, 0.77f, 1.0f})
    CHECK(scale.place_of(scale.value_at(place)) == Approx(place).margin(1e-5));
  CHECK(scale.place_of(0.01f) == 0);
  CHECK(scale.place_of(kInfinity) == 1);
  CHECK(scale.place_of(kNaN) == 0);
  CHECK(opacity_scale().place_of(render::SplatStyle{}.opacity) == Approx(0.5).margin(1e-5));
  VolumeSummary summary;
  for (const auto& magnitudes : {std::vector<float>{}, {5.0f}, {1e-30f, 1e30f}, {3.0f, 3.0f, 3.0f}}) {
    summary.magnitudes = magnitudes;
    const LogScale magnitude = magnitude_scale(summary);
    CHECK(magnitude.least > 0);
    CHECK(magnitude.largest > magnitude.least);
    CHECK(std::isfinite(magnitude.value_at(0.5f)));
  }
}

TEST_CASE("moves clipping planes across the whole scene") {
  const Box bounds = box({-1, 10, 0}, {3, 20, 2});
  ClipChoice choice;
  choice.axis = ClipAxis::y;
  choice.place = 0.25f;
  const glm::vec4 plane = clip_plane(choice, bounds);
  CHECK(side(plane, {0, 12.4f, 0}) < 0);
  CHECK(side(plane, {0, 12.6f, 0}) > 0);
  choice.place = 0;
  CHECK(side(clip_plane(choice, bounds), {0, 10.001f, 0}) > 0);
  choice.place = 1;
  CHECK(side(clip_plane(choice, bounds), {0, 19.999f, 0}) < 0);
  choice.axis = ClipAxis::view;
  choice.view = {0, 0, -3};  // need not be of unit length
  choice.place = 0.5f;
  CHECK(side(clip_plane(choice, bounds), {0, 0, 0.9f}) == Approx(0.1).margin(1e-5));
}

TEST_CASE("keeps the position of a flipped plane") {
  const Box bounds = box({-1, 10, 0}, {3, 20, 2});
  for (const ClipAxis axis : {ClipAxis::x, ClipAxis::y, ClipAxis::z, ClipAxis::view}) {
    ClipChoice choice;
    choice.axis = axis;
    choice.view = glm::normalize(glm::vec3(1, -2, 0.5f));
    choice.place = 0.3f;
    const glm::vec4 plane = clip_plane(choice, bounds), other = clip_plane(flipped(choice), bounds);
    for (int i = 0; i < 4; ++i) CHECK(other[i] == Approx(-plane[i]).margin(1e-5));
  }
}

TEST_CASE("derives the choice from the plane") {
  const Box bounds = box({-1, 10, 0}, {3, 20, 2});
  for (const ClipAxis axis : {ClipAxis::x, ClipAxis::y, ClipAxis::z, ClipAxis::view})
    for (const bool flip : {false, true}) {
      ClipChoice choice;
      choice.axis = axis;
      choice.flip = axis != ClipAxis::view && flip;
      choice.view = glm::normalize(glm::vec3(0.5f, 0.2f, -1));
      choice.place = 0.3f;
      const glm::vec4 plane = clip_plane(choice, bounds);
      const ClipChoice again = clip_choice(plane * 2.0f, bounds);
      CHECK(again.axis == choice.axis);
      CHECK(again.flip == choice.flip);
      CHECK(again.place == Approx(0.3).margin(1e-5));
      const glm::vec4 plane_again = clip_plane(again, bounds);
      for (int i = 0; i < 4; ++i) CHECK(plane_again[i] == Approx(plane[i]).margin(1e-5));
    }
  (void)clip_choice(glm::vec4(kNaN), bounds);
  (void)clip_choice(glm::vec4(0), {});
  CHECK(std::isfinite(clip_plane({}, {}).w));
}
