#include "app/media/sound_attenuation.h"

#include <catch2/catch.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gs::app::sound_attenuation_test {
namespace {

double decibels(double factor) { return 20 * std::log10(factor); }

glm::dmat4 viewer_at(double x, double y, double z) { return glm::translate(glm::dmat4(1), glm::dvec3(x, y, z)); }

render::SoundState sound_of(double min_front, double min_back, double max_front, double max_back) {
  render::SoundState sound;
  sound.min_front = min_front;
  sound.min_back = min_back;
  sound.max_front = max_front;
  sound.max_back = max_back;
  return sound;
}

TEST_CASE("places a Sound at a focus of its ellipsoids, which meet the axis at front and back (6.42)") {
  CHECK(ellipsoid_radius(6, 2, 1) == Approx(6));
  CHECK(ellipsoid_radius(6, 2, -1) == Approx(2));
  // For each point of the ellipsoid, the distances from both foci add up to the long axis. The other focus is 6 - 2
  // units ahead.
  for (const double cosine : {-0.9, -0.3, 0.0, 0.2, 0.7}) {
    const double radius = ellipsoid_radius(6, 2, cosine);
    const double x = radius * cosine, y = radius * std::sqrt(1 - cosine * cosine);
    CHECK(radius + std::hypot(x - 4, y) == Approx(8));
  }
  CHECK(ellipsoid_radius(3, 3, 0.4) == Approx(3));
  CHECK(ellipsoid_radius(0, 0, 1) == 0);
  CHECK(ellipsoid_radius(5, 0, 0) == 0);
}

TEST_CASE("attenuates by 20 dB between the ellipsoids, evenly in dB, and mutes beyond (6.42)") {
  render::SoundState sound = sound_of(2, 1, 12, 6);
  sound.spatialize = false;
  const auto level = [&](double x, double y, double z) { return sound_attenuation(sound, viewer_at(x, y, z)).level; };
  // In front, the level falls from 2 to 12.
  CHECK(level(0, 0, 0) == 1);
  CHECK(level(0, 0, 2) == 1);
  for (const double d : {3.0, 7.0, 11.0, 12.0}) CHECK(decibels(level(0, 0, d)) == Approx(-20 * (d - 2) / 10));
  CHECK(level(0, 0, 12.001) == 0);
  // Behind, the level falls from 1 to 6.
  CHECK(level(0, 0, -1) == 1);
  CHECK(decibels(level(0, 0, -3.5)) == Approx(-10));
  CHECK(level(0, 0, -6.001) == 0);
  // At the side, the distances are 2 f b / (f + b), with f in front and b behind.
  const double inner = 4.0 / 3, outer = 8;
  CHECK(decibels(level((inner + outer) / 2, 0, 0)) == Approx(-10));
  CHECK(level(0, outer + 0.001, 0) == 0);
}

TEST_CASE("measures the ellipsoids of a Sound in its own coordinates (6.42)") {
  render::SoundState sound = sound_of(1, 1, 10, 10);
  sound.spatialize = false;
  sound.direction = {1, 0, 0};
  sound.location = {0, 2, 0};
  sound.world_from_local = glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(5, 0, 0)), glm::dvec3(2, 1, 1));
  CHECK(decibels(sound_attenuation(sound, viewer_at(5 + 2 * 5.5, 2, 0)).level) == Approx(-10));
  CHECK(decibels(sound_attenuation(sound, viewer_at(5, 2, 5.5)).level) == Approx(-10));
  CHECK(sound_attenuation(sound, viewer_at(5 + 20.1, 2, 0)).level == 0);
  sound.world_from_local = glm::scale(glm::dmat4(1), glm::dvec3(0, 1, 1));  // the inner ellipsoid is empty
  CHECK(sound_attenuation(sound, viewer_at(0, 2, 0)).level == 0);
}

TEST_CASE("converts intensity to loudness: 0 dB at 1, towards -20 dB at 0, which is silent (6.42)") {
  CHECK(intensity_factor(1) == 1);
  CHECK(decibels(intensity_factor(0.5)) == Approx(-10));
  CHECK(decibels(intensity_factor(1e-9)) == Approx(-20));
  CHECK(intensity_factor(0) == 0);
  render::SoundState sound = sound_of(1, 1, 11, 11);
  sound.intensity = 0.25;
  sound.spatialize = false;
  CHECK(decibels(sound_attenuation(sound, viewer_at(0, 0, 6)).level) == Approx(-15 - 10));
}

TEST_CASE("pans by the angle in the viewer's XZ plane: 1 - pan^2 and 1 - (1 - pan)^2 (7.3.4.2)") {
  const auto check = [](glm::dvec3 place, double pan) {
    const Pan found = pan_of(place);
    CHECK(found.left == Approx(1 - pan * pan));
    CHECK(found.right == Approx(1 - (1 - pan) * (1 - pan)));
  };
  check({0, 0, -5}, 0.5);
  check({0, 0, 5}, 0.5);
  check({3, 0, 0}, 1);
  check({-3, 9, 0}, 0);  // height has no effect
  check({1, 0, -1}, 0.75);
  check({1, -4, 1}, 0.75);
  check({-1, 0, -1}, 0.25);
  check({-std::sin(0.3), 0, -std::cos(0.3)}, 0.5 - 0.3 / glm::pi<double>());
  check({0, 7, 0}, 0.5);
}

TEST_CASE("pans between the ellipsoids if spatialize is TRUE, and not inside the inner one (6.42)") {
  render::SoundState sound = sound_of(1, 1, 11, 11);
  // The viewer looks along -X from six units: the sound is on the right.
  const glm::dmat4 turned = glm::rotate(viewer_at(0, 0, 6), glm::half_pi<double>(), glm::dvec3(0, 1, 0));
  Heard heard = sound_attenuation(sound, turned);
  CHECK(decibels(heard.level) == Approx(-10));
  CHECK(heard.right == Approx(heard.level));
  CHECK(heard.left == Approx(0).margin(1e-12));
  heard = sound_attenuation(sound, viewer_at(0, 0, 6));
  CHECK(heard.left == Approx(0.75 * heard.level));
  CHECK(heard.right == Approx(0.75 * heard.level));
  sound.spatialize = false;
  heard = sound_attenuation(sound, turned);
  CHECK(heard.left == heard.level);
  CHECK(heard.right == heard.level);
  sound.spatialize = true;
  heard = sound_attenuation(sound, viewer_at(0.5, 0, 0));
  CHECK(heard.left == 1);
  CHECK(heard.right == 1);
}

TEST_CASE("prefers high priority, then new and loud sounds, if there are too many (7.3.4.1)") {
  std::vector<SoundRank> ranks = {{0, 5, 0.9},  {0.8, 1, 0.2}, {0, 9, 0.95}, {0.8, 7, 0.1},
                                  {1, 0, 0.01}, {0.5, 3, 0.3}, {0.5, 4, 0.2}};
  std::sort(ranks.begin(), ranks.end());
  const std::vector<double> levels = {0.01, 0.1, 0.2, 0.3, 0.2, 0.95, 0.9};
  REQUIRE(ranks.size() == levels.size());
  for (std::size_t i = 0; i < ranks.size(); ++i) CHECK(ranks[i].level == levels[i]);
}

}  // namespace
}  // namespace gs::app::sound_attenuation_test
