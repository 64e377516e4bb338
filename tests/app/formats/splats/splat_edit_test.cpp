#include "app/formats/splats/splat_edit.h"

#include "app/commands/options/options.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"
#include "render/gaussians/gaussian_harmonics.h"
#include "tests/app/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace gs::app {
namespace splat_edit_test {

using gs::test::check_gaussians;
using gs::test::random_gaussians;
using qnv::Gaussians;

glm::mat3 covariance(const Gaussians& splats, std::size_t i) {
  const auto c = qnv::gaussians::covariance_of(splats.scales[i], splats.rotations[i]);
  return glm::mat3(c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]);
}

glm::vec3 color(const Gaussians& splats, std::size_t i, const glm::vec3& direction) {
  const std::size_t per = qnv::harmonic_count(splats.degree);
  return render::gaussian_color(splats.bases[i], splats.harmonics.data() + i * per, splats.degree, direction);
}

TEST_CASE("keeps the splats in any region to keep, except those in regions to remove, in their order") {
  const Gaussians all = random_gaussians(500, 1);
  const SplatBox box{{-1, -0.5, -2}, {1, 1.5, 0.5}}, small{{-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}};
  const SplatBall ball{{0.8, 0, 0}, 0.9};
  const auto in_box = [](const SplatBox& region, const glm::dvec3& p) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && p[k] >= region.lower[k] && p[k] <= region.upper[k];
    return inside;
  };
  const auto in_ball = [&](const glm::dvec3& p) { return glm::distance(p, ball.center) <= ball.radius; };
  struct Case {
    std::vector<SplatCrop> crops;
    std::function<bool(const glm::dvec3&)> is_kept;
  };
  const Case cases[] = {
      {{{box}}, [&](const glm::dvec3& p) { return in_box(box, p); }},
      {{{box}, {ball}}, [&](const glm::dvec3& p) { return in_box(box, p) || in_ball(p); }},
      {{{ball, true}}, [&](const glm::dvec3& p) { return !in_ball(p); }},
      {{{ball, true}, {small, true}}, [&](const glm::dvec3& p) { return !in_ball(p) && !in_box(small, p); }},
      {{{small, true}, {box}, {ball}},
       [&](const glm::dvec3& p) { return (in_box(box, p) || in_ball(p)) && !in_box(small, p); }}};
  for (const Case& one : cases) {
    SplatEdit edit;
    edit.crops = one.crops;
    Gaussians edited = all;
    const SplatsRemoved removed = edit_splats(edited, edit);
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (one.is_kept(glm::dvec3(all.positions[i]))) expected.push_back(i);
    REQUIRE(edited.size() == expected.size());
    CHECK(removed.before == 500);
    CHECK(removed.cropped == 500 - expected.size());
    CHECK(removed.cropped > 0);
    CHECK(removed.all() == removed.cropped);
    check_gaussians(edited);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CHECK(edited.positions[i] == all.positions[expected[i]]);
      CHECK(edited.rotations[i] == all.rotations[expected[i]]);
      CHECK(edited.harmonics[3 * i + 2] == all.harmonics[3 * expected[i] + 2]);
    }
    CHECK(messages_of(removed).size() == 1);
  }
}

TEST_CASE("removes faint and large splats") {
  const Gaussians all = random_gaussians(400, 0);
  SplatEdit edit;
  edit.least_opacity = 0.3;
  edit.most_size = 0.8;
  Gaussians edited = all;
  const SplatsRemoved removed = edit_splats(edited, edit);
  std::size_t faint = 0, large = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_faint = all.opacities[i] < 0.3f;
    faint += is_faint ? 1 : 0;
    large += !is_faint && std::max({all.scales[i].x, all.scales[i].y, all.scales[i].z}) > 0.8f ? 1 : 0;
  }
  REQUIRE(faint > 0);
  REQUIRE(large > 0);
  CHECK(removed.faint == faint);
  CHECK(removed.large == large);
  CHECK(edited.size() == 400 - faint - large);
  check_gaussians(edited);
}

TEST_CASE("moves, turns and scales splats, their shapes and their harmonics") {
  Gaussians all = random_gaussians(60, 3);
  all.description.origin = {100000, 0, -20};
  SplatEdit edit;
  edit.scale = 2.5;
  edit.turn = {30, -50, 110};
  edit.move = {1, 2, 3};
  const glm::dmat4 matrix = matrix_of(edit);
  const glm::mat3 linear{glm::dmat3(matrix)};
  Gaussians edited = all;
  CHECK(edit_splats(edited, edit).all() == 0);
  check_gaussians(edited);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const glm::dvec3 before = all.description.origin + glm::dvec3(all.positions[i]);
    const glm::dvec3 after = edited.description.origin + glm::dvec3(edited.positions[i]);
    CHECK(glm::distance(glm::dvec3(matrix * glm::dvec4(before, 1)), after) < 1e-2);
    const glm::mat3 wanted = linear * covariance(all, i) * glm::transpose(linear), found = covariance(edited, i);
    for (int k = 0; k < 3; ++k) CHECK(glm::distance(wanted[k], found[k]) < 1e-4f);
    CHECK(edited.weights[i] == Approx(all.weights[i] * 6.25f));
    const glm::vec3 direction = glm::normalize(glm::vec3(1, -2, 0.5f));
    const glm::vec3 wanted_color = color(all, i, direction),
                    found_color = color(edited, i, glm::normalize(linear * direction));
    CHECK(glm::distance(wanted_color, found_color) < 1e-3f);
    CHECK(glm::distance(glm::normalize(linear * all.normals[i]), edited.normals[i]) < 1e-4f);
  }
}

TEST_CASE("turns about the axes in the order x, y, z") {
  SplatEdit edit;
  edit.turn = {90, 0, 90};
  const glm::dvec4 up = matrix_of(edit) * glm::dvec4(0, 1, 0, 1);
  CHECK(glm::distance(glm::dvec3(up), glm::dvec3(0, 0, 1)) < 1e-12);
  const glm::dvec4 back = matrix_of(edit) * glm::dvec4(0, 0, 1, 1);
  CHECK(glm::distance(glm::dvec3(back), glm::dvec3(1, 0, 0)) < 1e-12);
}

TEST_CASE("exposes the colours of splats in every direction") {
  const Gaussians all = random_gaussians(30, 2);
  SplatEdit edit;
  edit.exposure = 1.1;
  Gaussians edited = all;
  (void)edit_splats(edited, edit);
  const float factor = std::pow(2.0f, 0.5f);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const glm::vec3 direction = glm::normalize(glm::vec3(0.3f, 1, -0.4f));
    CHECK(glm::distance(color(all, i, direction) * factor, color(edited, i, direction)) < 1e-3f);
  }
  CHECK(edited.colors != all.colors);
}

TEST_CASE("removes splats that an edit moves out of the range of coordinates") {
  Gaussians splats = random_gaussians(20, 0);
  splats.positions[3] = glm::vec3(1e15f);
  SplatEdit edit;
  edit.scale = 1e6;
  edit.move = {1e17, 0, 0};
  const SplatsRemoved removed = edit_splats(splats, edit);
  CHECK(removed.far == 1);
  CHECK(splats.size() == 19);
  edit.move = {1e300, 0, std::numeric_limits<double>::infinity()};
  CHECK(edit_splats(splats, edit).far == 19);
  CHECK(splats.empty());
}

TEST_CASE("writes an edit as options that give the same edit") {
  SplatEdit edit;
  CHECK(edit.empty());
  CHECK(options_of(edit).empty());
  edit.crops = {{SplatBox{{-1, -0.1, 1e-7}, {1, 1.0 / 3, 2}}},
                {SplatBall{{0.25, -1e9, 0}, 3.5}, true},
                {SplatBox{{-2, -2, -2}, {2, 2, 2}}, true},
                {SplatBall{{1, 2, 3}, 0.1}}};
  edit.least_opacity = 0.07;
  edit.most_size = 0.125;
  edit.scale = 0.1;
  edit.turn = {-90, 0, 12.5};
  edit.move = {1, 2, -3};
  edit.exposure = -0.7;
  const CommandRow* command = nullptr;
  for (const CommandRow& row : command_rows())
    if (row.name == "export") command = &row;
  REQUIRE(command);
  const auto read = command->calls.defaults();
  const std::vector<std::string> words = options_of(edit);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const OptionRow* option = nullptr;
    for (const OptionRow& row : option_rows())
      if (row.name == words[i]) option = &row;
    INFO(words[i]);
    REQUIRE(option);
    REQUIRE(accepts(*command, *option));
    CHECK_FALSE(option->set(*read, option->argument.empty() ? "" : words[++i]));
  }
  CHECK(dynamic_cast<const SplatEditOptions&>(*read).splats == edit);
}

}  // namespace splat_edit_test
}  // namespace gs::app
