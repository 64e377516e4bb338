#include "app/encode/grids/grid_surface.h"

#include "app/base/local_file.h"
#include "app/commands/common/open_input.h"
#include "app/encode/grids/outer_faces.h"
#include "base/gzip.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/surface_triangles.h"
#include "tests/qnv/thread_ranks.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::grid_surface_test {
namespace {

/// Storage of the arrays of a file.
struct Storage {
  bool appended = true, base64 = false, packed = false, wide_header = false, doubles = false;
};

std::string base64_of(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= bytes.size() - i ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Writer of VTK XML files.
class VtuText {
 public:
  explicit VtuText(const Storage& storage) : storage_(storage) {}

  template <class T>
  void add(const std::string& type, const std::string& name, const std::vector<T>& values, int components = 1) {
    const std::string stored = stored_form(raw(values));
    text_ += "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
             std::to_string(components) + "\" ";
    if (storage_.appended) {
      text_ += "format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
      data_ += stored;
    } else {
      text_ += "format=\"binary\">\n  " + stored + "\n</DataArray>\n";
    }
  }
  void section(const std::string& tag) { text_ += "<" + tag + ">\n"; }

  std::string whole() const {
    std::string out = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"";
    out += storage_.wide_header ? "UInt64\"" : "UInt32\"";
    if (storage_.packed) out += " compressor=\"vtkZLibDataCompressor\"";
    out += "><UnstructuredGrid>\n" + text_ + "</UnstructuredGrid>\n";
    if (storage_.appended)
      out += std::string("<AppendedData encoding=\"") + (storage_.base64 ? "base64" : "raw") + "\">\n_" + data_ +
             "\n</AppendedData>";
    return out + "</VTKFile>\n";
  }

 private:
  std::string words(const std::vector<std::uint64_t>& numbers) const {
    std::string out;
    for (const std::uint64_t number : numbers)
      out.append(reinterpret_cast<const char*>(&number), storage_.wide_header ? 8 : 4);
    return out;
  }
  std::string stored_form(const std::string& bytes) const {
    const bool text = storage_.base64 || !storage_.appended;
    std::string head, data;
    if (storage_.packed) {
      constexpr std::size_t kBlock = 1000;
      std::vector<std::uint64_t> table{(bytes.size() + kBlock - 1) / kBlock, kBlock, bytes.size() % kBlock};
      for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
        const auto packed = gzip(std::as_bytes(std::span(bytes).subspan(at, std::min(kBlock, bytes.size() - at))));
        table.push_back(packed.size());
        data.append(reinterpret_cast<const char*>(packed.data()), packed.size());
      }
      head = words(table);
    } else {
      head = words({bytes.size()});
      data = bytes;
    }
    if (!text) return head + data;
    return storage_.packed ? base64_of(head) + base64_of(data) : base64_of(head + data);
  }

  Storage storage_;
  std::string text_, data_;
};

struct GridFacts {
  std::string text;
  std::size_t outer = 0;  // number of triangles of the outer faces and of other polygons
};

/// Returns a grid of n * n * layers warped hexahedra with a hole, and one triangle.
GridFacts hexahedra(std::int32_t n, std::int32_t layers, const Storage& storage, bool by_cell = false) {
  std::vector<float> points;
  std::vector<double> wide;
  std::vector<float> values, cell_values;
  const auto at = [n](std::int32_t x, std::int32_t y, std::int32_t z) { return (z * (n + 1) + y) * (n + 1) + x; };
  for (std::int32_t z = 0; z <= layers; ++z)
    for (std::int32_t y = 0; y <= n; ++y)
      for (std::int32_t x = 0; x <= n; ++x) {
        const float p[3] = {static_cast<float>(x), static_cast<float>(y) + 0.125f * static_cast<float>(z % 3),
                            static_cast<float>(z) + 0.25f * static_cast<float>(x % 2)};
        for (const float one : p) {
          points.push_back(one);
          wide.push_back(1e7 + static_cast<double>(one));
        }
        values.push_back(p[0] * 2 + p[2]);
      }
  std::vector<std::int64_t> corners, ends;
  std::vector<std::uint8_t> types;
  GridFacts facts;
  const auto filled = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
    return x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < layers && (x + 5 * y + 7 * z) % 11 != 0;
  };
  for (std::int32_t z = 0; z < layers; ++z)
    for (std::int32_t y = 0; y < n; ++y)
      for (std::int32_t x = 0; x < n; ++x) {
        if (!filled(x, y, z)) continue;
        const std::int32_t cell[8] = {
            at(x, y, z),     at(x + 1, y, z),     at(x + 1, y + 1, z),     at(x, y + 1, z),
            at(x, y, z + 1), at(x + 1, y, z + 1), at(x + 1, y + 1, z + 1), at(x, y + 1, z + 1)};
        corners.insert(corners.end(), std::begin(cell), std::end(cell));
        ends.push_back(static_cast<std::int64_t>(corners.size()));
        types.push_back(12);
        cell_values.push_back(static_cast<float>(x + y + z));
        const std::array<std::array<std::int32_t, 3>, 6> beside{
            {{x - 1, y, z}, {x + 1, y, z}, {x, y - 1, z}, {x, y + 1, z}, {x, y, z - 1}, {x, y, z + 1}}};
        for (const auto& [i, k, l] : beside) facts.outer += filled(i, k, l) ? 0 : 2;
      }
  for (const std::int32_t corner : {at(0, 0, 0), at(n, n, layers), at(n, 0, layers)}) corners.push_back(corner);
  ends.push_back(static_cast<std::int64_t>(corners.size()));
  types.push_back(5);
  cell_values.push_back(3);
  ++facts.outer;
  VtuText vtu(storage);
  vtu.section("Piece NumberOfPoints=\"" + std::to_string(points.size() / 3) + "\" NumberOfCells=\"" +
              std::to_string(types.size()) + "\"");
  vtu.section("PointData");
  if (!by_cell) vtu.add("Float32", "heat", values);
  vtu.section("/PointData");
  vtu.section("CellData");
  if (by_cell) vtu.add("Float32", "load", cell_values);
  vtu.section("/CellData");
  vtu.section("Points");
  if (storage.doubles)
    vtu.add("Float64", "Points", wide, 3);
  else
    vtu.add("Float32", "Points", points, 3);
  vtu.section("/Points");
  vtu.section("Cells");
  vtu.add("Int64", "connectivity", corners);
  vtu.add("Int64", "offsets", ends);
  vtu.add("UInt8", "types", types);
  vtu.section("/Cells");
  vtu.section("/Piece");
  facts.text = vtu.whole();
  return facts;
}

std::optional<LargeGrid> opened(const std::string& path, std::uint64_t memory = 1) {
  auto mapped = net::map_file(path);
  REQUIRE(std::holds_alternative<net::MappedFile>(mapped));
  const auto file = std::make_shared<const net::MappedFile>(std::move(std::get<net::MappedFile>(mapped)));
  return open_large_grid({path, "grid", {file, file->bytes()}, reader_beside(path, {})}, memory);
}

using GridResult = std::variant<MeshStream, qnv::EncodeError>;

/// Collects the triangles of a surface.
std::vector<qnv::Triangle> triangles_of(const MeshStream& stream) {
  std::vector<qnv::Triangle> all;
  CHECK(stream.source([&](std::span<const qnv::Triangle> some) {
    all.insert(all.end(), some.begin(), some.end());
    return true;
  }));
  CHECK(all.size() == stream.faces);
  return all;
}

/// Triangles of a grid that one process reads.
struct AloneSurface {
  qnv::EncodeOptions options;
  qnv::EncodeRanks shared{options};
  GridResult result;

  explicit AloneSurface(const LargeGrid& grid, std::uint64_t memory = 1 << 20)
      : result(grid_surface(grid, shared, memory, nullptr)) {}
  [[nodiscard]] const MeshStream& stream() const {
    if (const auto* const problem = std::get_if<qnv::EncodeError>(&result)) FAIL(problem->message);
    return std::get<MeshStream>(result);
  }
};

double area_of(std::span<const qnv::Triangle> triangles) {
  double area = 0;
  for (const qnv::Triangle& t : triangles)
    area += glm::length(glm::cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0])) / 2;
  return area;
}

bool equal(std::span<const qnv::Triangle> a, std::span<const qnv::Triangle> b) {
  return std::ranges::equal(a, b, [](const qnv::Triangle& p, const qnv::Triangle& q) {
    return p.positions == q.positions && p.colors == q.colors;
  });
}

/// Checks the triangles that ranks return. `state` keeps their stores and finished work.
void check_ranks(const LargeGrid& grid, qnv::SharedMemory& state, std::span<const qnv::Triangle> triangles) {
  const auto count = static_cast<std::uint32_t>(state.stores.size());
  std::vector<std::vector<qnv::Triangle>> results(count);
  std::vector<std::string> problems(count);
  std::vector<std::jthread> threads;
  for (std::uint32_t rank = 0; rank < count; ++rank)
    threads.emplace_back([&, rank] {
      qnv::ThreadRanks ranks(state, rank);
      qnv::RankStore store(state, rank);
      qnv::EncodeOptions options;
      options.ranks = &ranks;
      options.spill = &store;
      qnv::EncodeRanks shared(options);
      const GridResult result = grid_surface(grid, shared, 8 << 20, nullptr);
      state.barrier.arrive_and_wait();
      if (const auto* const problem = std::get_if<qnv::EncodeError>(&result)) {
        problems[rank] = problem->message;
        return;
      }
      (void)std::get<MeshStream>(result).source([&](std::span<const qnv::Triangle> some) {
        results[rank].insert(results[rank].end(), some.begin(), some.end());
        return true;
      });
    });
  threads.clear();
  for (std::uint32_t rank = 0; rank < count; ++rank) {
    CHECK(problems[rank].empty());
    CHECK(equal(results[rank], triangles));
  }
}

}  // namespace

TEST_CASE("a grid that is read in parts has the same surface as its import") {
  const bool by_cell = GENERATE(false, true);
  const ScratchFolder folder;
  const GridFacts facts = hexahedra(6, 9, {}, by_cell);
  const std::string path = folder.write("grid.vtu", facts.text);
  const auto grid = opened(path);
  REQUIRE(grid);
  const AloneSurface made(*grid);
  const auto triangles = triangles_of(made.stream());
  CHECK(triangles.size() == facts.outer);
  InputOptions options;
  const auto input = open_input(options, path);
  REQUIRE(input);
  const auto& whole = std::get<MeshSurface>(input->content);
  const std::vector<qnv::Triangle> imported = test::triangles_of(whole);
  CHECK(imported.size() == triangles.size());
  CHECK(area_of(triangles) == Approx(area_of(imported)).epsilon(0.01));
  REQUIRE(whole.color_key);
  REQUIRE(made.stream().color_key);
  CHECK(color_key_text(*made.stream().color_key) == color_key_text(*whole.color_key));
  // The surfaces from parts and from the importer have equal corners with equal colours.
  const auto corners_of = [](std::span<const qnv::Triangle> all) {
    std::vector<std::array<float, 6>> corners;
    for (const qnv::Triangle& t : all)
      for (std::size_t i = 0; i < 3; ++i)
        corners.push_back({t.positions[i].x, t.positions[i].y, t.positions[i].z, static_cast<float>(t.colors[i].r),
                           static_cast<float>(t.colors[i].g), static_cast<float>(t.colors[i].b)});
    std::ranges::sort(corners);
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
  };
  CHECK(corners_of(triangles) == corners_of(imported));
}

TEST_CASE("a grid is read in parts in each form of binary data") {
  const ScratchFolder folder;
  const auto expected = opened(folder.write("plain.vtu", hexahedra(5, 6, {}).text));
  REQUIRE(expected);
  const AloneSurface plain(*expected);
  const auto triangles = triangles_of(plain.stream());
  for (const bool appended : {true, false})
    for (const bool base64 : {true, false})
      for (const bool packed : {true, false})
        for (const bool wide_header : {true, false}) {
          if (!appended && !base64) continue;
          CAPTURE(appended, base64, packed, wide_header);
          const auto grid =
              opened(folder.write("form.vtu", hexahedra(5, 6, {appended, base64, packed, wide_header}).text));
          REQUIRE(grid);
          CHECK(equal(triangles_of(AloneSurface(*grid).stream()), triangles));
        }
  // A reader keeps fewer blocks than this grid has.
  const auto whole = opened(folder.write("whole.vtu", hexahedra(16, 16, {}).text)),
             blocks = opened(folder.write("blocks.vtu", hexahedra(16, 16, {true, false, true}).text));
  REQUIRE(whole);
  REQUIRE(blocks);
  CHECK(equal(triangles_of(AloneSurface(*blocks).stream()), triangles_of(AloneSurface(*whole).stream())));
}

TEST_CASE("coordinates of double precision keep it") {
  const ScratchFolder folder;
  Storage storage;
  storage.doubles = true;
  const auto grid = opened(folder.write("wide.vtu", hexahedra(4, 4, storage).text));
  REQUIRE(grid);
  const AloneSurface made(*grid);
  const MeshStream& stream = made.stream();
  CHECK(stream.origin.x == Approx(1e7).margin(10));
  CHECK(stream.size.x == 4);
  for (const qnv::Triangle& triangle : triangles_of(stream))
    for (const glm::vec3& p : triangle.positions)
      CHECK(std::fmod((static_cast<double>(p.x) + stream.origin.x) * 8, 1.0) == 0);
}

TEST_CASE("ranks that share a grid return the triangles of one process, with any memory limit") {
  const ScratchFolder folder;
  for (const char* name : {"a.vtu", "b.vtu"}) folder.write(name, hexahedra(42, 40, {}).text);
  const std::string path = folder.write(
      "pieces.pvtu",
      "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid GhostLevel=\"0\"><PPointData>"
      "<PDataArray type=\"Float32\" Name=\"heat\"/></PPointData><PPoints><PDataArray type=\"Float32\" "
      "NumberOfComponents=\"3\"/></PPoints><Piece Source=\"a.vtu\"/><Piece Source=\"b.vtu\"/></PUnstructuredGrid>"
      "</VTKFile>");
  const auto grid = opened(path);
  REQUIRE(grid);
  REQUIRE(grid->parts.size() == 2);
  REQUIRE(grid->runs.size() == 2);
  const AloneSurface alone(*grid, 64 << 20);
  const auto triangles = triangles_of(alone.stream());
  CHECK(equal(triangles_of(AloneSurface(*grid, 8 << 20).stream()), triangles));
  for (const std::uint32_t count : {2u, 3u}) {
    qnv::SharedMemory state(count);
    check_ranks(*grid, state, triangles);
    CHECK(state.restored == 0);
    // A later run uses the results of an earlier run. Some are missing, as if the earlier run had ended at any moment.
    const auto finished = state.finished;
    const auto repeat_without = [&](const std::vector<std::string>& works) {
      state.finished = finished;
      std::erase_if(state.finished, [&](const auto& one) {
        return std::ranges::any_of(works, [&](const std::string& work) { return one.first.starts_with(work); });
      });
      state.restored = 0;
      check_ranks(*grid, state, triangles);
      return state.restored;
    };
    CHECK(repeat_without({}) == count + 2);  // the ranges on all ranks, and the triangles of two runs
    CHECK(repeat_without({"triangles 1"}) >= count + 1 + 64);
    CHECK(repeat_without({"triangles", "bucket"}) == count + 2);
    CHECK(repeat_without({"triangles", "bucket 64 1", "faces 64 0"}) > 50);
    CHECK(repeat_without({"ranges"}) == 2);
  }
}

TEST_CASE("only grids that exceed memory are read in parts") {
  const ScratchFolder folder;
  const std::string path = folder.write("grid.vtu", hexahedra(5, 5, {}).text);
  CHECK(opened(path, 1 << 10));
  CHECK_FALSE(opened(path, 100 << 20));
  CHECK_FALSE(opened(folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")));
}

TEST_CASE("a small file that states very many cells is not read in parts") {
  const ScratchFolder folder;
  const auto grid_of = [&](int pieces) {
    std::string text = "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\"><UnstructuredGrid>\n";
    for (int i = 0; i < pieces; ++i) text += "<Piece NumberOfPoints=\"8\" NumberOfCells=\"2000000000\"/>\n";
    return opened(folder.write("many.vtu", text + "</UnstructuredGrid></VTKFile>\n"));
  };
  CHECK(grid_of(2));
  CHECK_FALSE(grid_of(200));
}

TEST_CASE("a damaged grid that is read in parts gives an error") {
  const ScratchFolder folder;
  const std::string whole = hexahedra(5, 5, {}).text;
  const auto problem_of = [&](const std::string& text) -> std::string {
    const auto grid = opened(folder.write("damaged.vtu", text));
    if (!grid) return "refused";
    const AloneSurface made(*grid);
    const auto* const problem = std::get_if<qnv::EncodeError>(&made.result);
    return problem ? problem->message : std::string();
  };
  CHECK(problem_of(whole).empty());
  for (const std::size_t cut : {100, 600, 3000}) CHECK_FALSE(problem_of(whole.substr(0, whole.size() - cut)).empty());
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  CHECK(problem_of(replaced("NumberOfPoints=\"216\"", "NumberOfPoints=\"999999999\"")).find("expected") !=
        std::string::npos);
  CHECK(problem_of(replaced("offset=\"0\"", "offset=\"99999999999\"")).find("offset") != std::string::npos);
  CHECK_FALSE(problem_of(replaced("type=\"Int64\" Name=\"offsets\"", "type=\"Float64\" Name=\"offsets\"")).empty());
  CHECK(problem_of(replaced("Name=\"types\"", "Name=\"typed\"")).find("types") != std::string::npos);
  // Compressed data with a table of blocks that exceeds the file.
  const std::string packed = hexahedra(5, 5, {true, false, true}).text;
  std::string wrong = packed;
  const std::size_t data = wrong.find("\n_") + 2;
  for (const std::size_t at : {data + 2, data + 14}) {
    wrong = packed;
    wrong[at] = '\x7f';
    CHECK_FALSE(problem_of(wrong).empty());
  }
}

TEST_CASE("counts the cells of a grid that its surface cannot show") {
  // A tetrahedron, a line, a vertex, two cells of unknown types, a triangle with two corners, and a hidden cell.
  const ScratchFolder folder;
  VtuText vtu({});
  vtu.section("Piece NumberOfPoints=\"4\" NumberOfCells=\"7\"");
  vtu.section("Points");
  vtu.add("Float32", "Points", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
  vtu.section("/Points");
  vtu.section("Cells");
  vtu.add("Int64", "connectivity", std::vector<std::int64_t>{0, 1, 2, 3, 0, 1, 2, 0, 1, 2, 1, 2, 0, 1});
  vtu.add("Int64", "offsets", std::vector<std::int64_t>{4, 6, 7, 9, 10, 12, 14});
  vtu.add("UInt8", "types", std::vector<std::uint8_t>{10, 3, 1, 200, 250, 5, 0});
  vtu.section("/Cells");
  vtu.section("/Piece");
  const auto grid = opened(folder.write("mixed.vtu", vtu.whole()));
  REQUIRE(grid);
  const AloneSurface made(*grid);
  CHECK(made.stream().faces == 4);
  CHECK(made.stream().omitted ==
        "2 lines and vertices, 2 cells of unsupported types, 1 cells without all of their corners are left out; the "
        "surface has the faces of the other cells");
  CHECK(AloneSurface(*opened(folder.write("whole.vtu", hexahedra(3, 3, {}).text))).stream().omitted.empty());
}

TEST_CASE("finds the pieces of a grid without regard to upper and lower case") {
  const ScratchFolder folder;
  folder.write("Piece_0.VTU", hexahedra(5, 5, {}).text);
  const auto grid = opened(folder.write(
      "grid.pvtu",
      "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid GhostLevel=\"0\"><PPoints><PDataArray "
      "type=\"Float32\" NumberOfComponents=\"3\"/></PPoints><Piece Source=\"piece_0.vtu\"/></PUnstructuredGrid>"
      "</VTKFile>"));
  REQUIRE(grid);
  CHECK(AloneSurface(*grid).stream().faces == hexahedra(5, 5, {}).outer);
}

TEST_CASE("notices that a file of a grid changed although its size did not, and names the file once") {
  namespace fs = std::filesystem;
  const ScratchFolder folder;
  const std::string text = hexahedra(5, 5, {}).text;
  const auto problem_of = [](const LargeGrid& grid) -> std::string {
    const AloneSurface made(grid);
    const auto* const problem = std::get_if<qnv::EncodeError>(&made.result);
    return problem ? problem->message : std::string();
  };
  const std::string path = folder.write("grid.vtu", text);
  const auto grid = opened(path);
  REQUIRE(grid);
  CHECK(problem_of(*grid).empty());
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(2));
  // The command adds the name of the first file.
  CHECK(problem_of(*grid) == "another program changed the file; encode it again");
  const std::string piece = folder.write("piece.vtu", text);
  const auto pieces = opened(folder.write(
      "grid.pvtu",
      "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\"><PUnstructuredGrid GhostLevel=\"0\"><PPoints><PDataArray "
      "type=\"Float32\" NumberOfComponents=\"3\"/></PPoints><Piece Source=\"piece.vtu\"/></PUnstructuredGrid>"
      "</VTKFile>"));
  REQUIRE(pieces);
  fs::last_write_time(piece, fs::last_write_time(piece) + std::chrono::seconds(2));
  CHECK(problem_of(*pieces) == piece + ": another program changed the file; encode it again");
  const auto again = opened(folder.path("grid.pvtu"));
  REQUIRE(again);
  CHECK(again->source->state() != pieces->source->state());
  CHECK(opened(folder.path("grid.pvtu"))->source->state() == again->source->state());
  fs::remove(piece);
  CHECK(problem_of(*again) == piece + ": cannot open: No such file or directory");
}

}  // namespace gs::app::grid_surface_test
