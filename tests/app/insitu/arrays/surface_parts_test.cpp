#include "app/insitu/arrays/surface_parts.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <filesystem>

namespace gs::app::insitu {
namespace surface_parts_test {

using namespace test;

/// Hexahedra in a row along x, with a field at the points.
struct Row {
  Row(int first, int end) {
    for (int x = first; x <= end; ++x)
      for (int i = 0; i < 4; ++i) {
        points.insert(points.end(), {static_cast<double>(x), i == 1 || i == 2 ? 1.0 : 0.0, i >= 2 ? 1.0 : 0.0});
        heat.push_back(static_cast<float>(x));
      }
    offsets.push_back(0);
    for (int c = 0; c < end - first; ++c) {
      // Bottom 0 1 2 3 at x, top 4 5 6 7 at x + 1.
      for (std::int32_t i = 0; i < 8; ++i) connectivity.push_back(4 * c + i);
      offsets.push_back(static_cast<std::int32_t>(connectivity.size()));
      types.push_back(12);
    }
    field.name = "heat";
    field.data = heat.data();
    field.type = GS_INSITU_FLOAT32;
    cells.size = sizeof cells;
    cells.points = points.data();
    cells.point_type = GS_INSITU_FLOAT64;
    cells.index_type = GS_INSITU_INT32;
    cells.point_count = points.size() / 3;
    cells.connectivity = connectivity.data();
    cells.connectivity_count = connectivity.size();
    cells.offsets = offsets.data();
    cells.types = types.data();
    cells.cell_count = types.size();
    cells.fields = &field;
    cells.field_count = 1;
  }
  std::vector<double> points;
  std::vector<float> heat;
  std::vector<std::int32_t> connectivity, offsets;
  std::vector<std::uint8_t> types;
  gs_insitu_field field{};
  gs_insitu_cells cells{};
};

CellsView view_of(const gs_insitu_cells& cells) {
  auto view = cells_view(cells);
  REQUIRE(std::holds_alternative<CellsView>(view));
  return std::get<CellsView>(view);
}

double area_of(std::span<const SurfaceTriangle> triangles) {
  double area = 0;
  for (const SurfaceTriangle& one : triangles) {
    std::array<glm::dvec3, 3> at;
    for (std::size_t i = 0; i < 3; ++i) at[i] = {one.positions[i][0], one.positions[i][1], one.positions[i][2]};
    area += glm::length(glm::cross(at[1] - at[0], at[2] - at[0])) / 2;
  }
  return area;
}

TEST_CASE("in situ cells: faces between two cells are inside") {
  const Row row(0, 3);
  const CellsView view = view_of(row.cells);
  std::uint64_t left_out = 0;
  const auto triangles = outer_triangles(std::span(&view, 1), facts_of(view.fields[0]), {}, left_out);
  CHECK(left_out == 0);
  CHECK(triangles.size() == 28);  // 4 sides of 3 cells, and 2 ends
  CHECK(area_of(triangles) == Approx(14));
  for (const SurfaceTriangle& one : triangles)
    for (std::size_t i = 0; i < 3; ++i) CHECK(one.values[i] == one.positions[i][0]);
}

TEST_CASE("in situ cells: each cell type has a closed surface that points outward") {
  // Points of a cube, and one above its top, for all types.
  const std::vector<float> points{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0.5, 0.5, 1};
  struct Shape {
    std::uint8_t type;
    std::vector<std::int64_t> points;
    double volume;
  };
  for (const Shape& shape : {Shape{10, {0, 1, 3, 4}, 1.0 / 6}, Shape{11, {0, 1, 3, 2, 4, 5, 7, 6}, 1},
                             Shape{12, {0, 1, 2, 3, 4, 5, 6, 7}, 1}, Shape{13, {0, 3, 1, 4, 7, 5}, 0.5},
                             Shape{14, {0, 1, 2, 3, 8}, 1.0 / 3}}) {
    INFO("type " << static_cast<int>(shape.type));
    const std::int64_t offsets[] = {0, static_cast<std::int64_t>(shape.points.size())};
    gs_insitu_cells cells{};
    cells.size = sizeof cells;
    cells.points = points.data();
    cells.point_type = GS_INSITU_FLOAT32;
    cells.index_type = GS_INSITU_INT64;
    cells.point_count = points.size() / 3;
    cells.connectivity = shape.points.data();
    cells.connectivity_count = shape.points.size();
    cells.offsets = offsets;
    cells.types = &shape.type;
    cells.cell_count = 1;
    const CellsView view = view_of(cells);
    std::uint64_t left_out = 0;
    const auto triangles = outer_triangles(std::span(&view, 1), {}, {}, left_out);
    double volume = 0;
    for (const SurfaceTriangle& one : triangles) {
      std::array<glm::dvec3, 3> at;
      for (std::size_t i = 0; i < 3; ++i) at[i] = {one.positions[i][0], one.positions[i][1], one.positions[i][2]};
      volume += glm::dot(at[0], glm::cross(at[1], at[2])) / 6;
      CHECK(std::isnan(one.values[0]));
    }
    CHECK(volume == Approx(shape.volume));
  }
}

TEST_CASE("in situ cells: wrong indices and unknown types are left out, and ghost cells hide faces") {
  Row row(0, 3);
  row.connectivity[9] = 1000;
  CellsView view = view_of(row.cells);
  std::uint64_t left_out = 0;
  auto triangles = outer_triangles(std::span(&view, 1), facts_of(view.fields[0]), {}, left_out);
  CHECK(left_out == 1);
  CHECK(triangles.size() == 24);
  row.connectivity[9] = -1;
  row.types[2] = 42;
  triangles = outer_triangles(std::span(&view, 1), facts_of(view.fields[0]), {}, left_out = 0);
  CHECK(left_out == 2);
  row.offsets[1] = 4000;
  CHECK(outer_triangles(std::span(&view, 1), {}, {}, left_out = 0).empty());
  CHECK(left_out == 3);

  Row hidden(0, 3);
  const std::uint8_t ghosts[] = {0, 0, 1};
  hidden.cells.ghosts = ghosts;
  view = view_of(hidden.cells);
  triangles = outer_triangles(std::span(&view, 1), facts_of(view.fields[0]), {}, left_out = 0);
  CHECK(area_of(triangles) == Approx(9));  // no face towards the ghost
}

TEST_CASE("in situ cells: the surface of all ranks has no faces between them, and keeps positions and values") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  ThreadRanks::run(3, [&](int rank, const gs_insitu_communicator& table) {
    gs_insitu_options options = plain_options();
    options.folder = folder.c_str();
    Session session(gs_insitu_open(&options, &table, nullptr, 0));
    Row row(2 * rank, 2 * rank + 2);
    for (std::size_t i = 0; i < row.points.size(); i += 3) row.points[i] += 1e6;
    if (gs_insitu_begin_step(session.get(), 0, 0) != GS_INSITU_OK) return;
    (void)gs_insitu_pass_cells(session.get(), &row.cells);
    (void)gs_insitu_end_step(session.get());
  });
  const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/heat-surface.000000.qnv"));
  const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
  REQUIRE(decoded.header);
  const auto* geometry = std::get_if<qnv::Geometry>(&decoded.content);
  REQUIRE(geometry);
  const auto* mesh = geometry->as<qnv::IndexedMesh>();
  REQUIRE(mesh);
  CHECK(mesh->triangles.size() == 3 * (4 * 6 * 2 + 4));
  const qnv::Description& about = geometry->description();
  double low = INFINITY, high = -INFINITY;
  for (const glm::vec3& at : mesh->positions) {
    const double x = about.origin.x + static_cast<double>(at.x) - 1e6;
    CHECK(std::abs(x - std::round(x)) <= 0.001 * 6);
    low = std::min(low, x);
    high = std::max(high, x);
  }
  CHECK(low == Approx(0).margin(0.006));
  CHECK(high == Approx(6).margin(0.006));
  bool keyed = false;
  for (const auto& [key, value] : about.metadata) keyed = keyed || (key == "color key" && value.starts_with("0 6 #"));
  CHECK(keyed);
}

}  // namespace surface_parts_test
}  // namespace gs::app::insitu
