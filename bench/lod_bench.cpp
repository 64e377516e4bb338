// lod_bench [--vectors N] [--budget B] [--frames F] [--folder DIR]: measures levels of detail of a stream larger than
// memory.
//
// Makes an octree stream of about N million vectors (50) of a closed, bumpy surface in DIR (by default a temporary
// folder; a named one keeps the file). Opens it in place and flies F frames (200) around and towards it, 1920x1080,
// with a budget of B million splats (2). Each setting runs in its own process. Prints a Markdown table: the time of a
// cut, decoded vectors, pieces, and kept memory.

#include "app/formats/qnv/geometry_reader.h"
#include "net/files/file.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/encode_options.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double peak_megabytes() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Returns the distance of the surface from the centre: bumps in octaves, each half as wide and high as the previous
/// one.
float radius_in(const glm::vec3& direction) {
  float radius = 1, height = 0.12f, scale = 3;
  for (int octave = 0; octave < 7; ++octave, height *= 0.5f, scale *= 2)
    radius += height * std::sin(scale * direction.x + 1.3f) * std::sin(scale * direction.y + 0.4f) *
              std::sin(scale * direction.z + 2.1f);
  return radius;
}

glm::vec3 surface_in(const glm::vec3& direction, float width) {
  const glm::vec3 p = direction * radius_in(direction);
  return {p.x, p.y * width, p.z * width};
}

/// Visits six grids of n by n quadrilaterals, as on a cube, moved to the surface.
bool for_each_triangle(int n, float width, const qnv::TriangleSink& sink) {
  const auto at = [&](int side, int i, int j) {
    const double u = std::tan((2.0 * i / n - 1) * 0.785398163397448),
                 v = std::tan((2.0 * j / n - 1) * 0.785398163397448);
    glm::dvec3 p(0);
    p[side / 2] = side % 2 == 0 ? 1 : -1;
    p[(side / 2 + 1) % 3] = side % 2 == 0 ? u : -u;
    p[(side / 2 + 2) % 3] = v;
    return surface_in(glm::vec3(glm::normalize(p)), width);
  };
  for (int side = 0; side < 6; ++side) {
    std::vector<glm::vec3> before(static_cast<std::size_t>(n) + 1), row(before);
    std::vector<qnv::Triangle> triangles;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; j <= n; ++j) row[static_cast<std::size_t>(j)] = at(side, i, j);
      triangles.clear();
      for (std::size_t j = 0; i > 0 && j + 1 < row.size(); ++j) {
        triangles.emplace_back().positions = {before[j], row[j], row[j + 1]};
        triangles.emplace_back().positions = {before[j], row[j + 1], before[j + 1]};
      }
      if (!sink(triangles)) return false;
      std::swap(before, row);
    }
  }
  return true;
}

// Returns the surface area, in faces of the surrounding cube.
double faces_of(int n, float width) {
  Box box;
  double area = 0;
  (void)for_each_triangle(n, width, [&](std::span<const qnv::Triangle> triangles) {
    for (const qnv::Triangle& t : triangles) {
      for (const glm::vec3& p : t.positions) box.add(p);
      area += 0.5 * glm::length(glm::cross(glm::dvec3(t.positions[1] - t.positions[0]),
                                           glm::dvec3(t.positions[2] - t.positions[0])));
    }
    return true;
  });
  const double edge = qnv::Cube::around(box).edge;
  return area / (edge * edge);
}

/// Returns the width at which a level of the octree has about `vectors` voxels, so that all vectors of the level are
/// used.
float width_for(double vectors) {
  constexpr double kVoxelsPerArea = 1.5;  // as the encoder counts
  constexpr int kCoarse = 200;
  constexpr double kSpare = 1.15;  // spare vectors, because the encoder omits voxels that the surface barely touches
  const auto voxels = [&](float width, int level) {
    return kVoxelsPerArea * faces_of(kCoarse, width) * std::pow(4.0, level);
  };
  int level = 1;
  while (level < qnv::kDeepestLevel && voxels(1, level) < vectors * kSpare) ++level;
  float low = 0.1f, high = 1;
  for (int i = 0; i < 20; ++i) {
    const float middle = (low + high) / 2;
    (voxels(middle, level) < vectors * kSpare ? low : high) = middle;
  }
  return high;
}

int make_stream(const std::string& path, double vectors) {
  const float width = width_for(vectors);
  const auto start = Clock::now();
  const int n = std::clamp(static_cast<int>(std::sqrt(vectors / 60)), 20, 2000);
  qnv::EncodeOptions options;
  options.vectors = static_cast<std::size_t>(vectors);
  auto encoded =
      qnv::encode_surface([&](const qnv::TriangleSink& sink) { return for_each_triangle(n, width, sink); }, options);
  if (const auto* error = std::get_if<qnv::EncodeError>(&encoded)) {
    std::fprintf(stderr, "%s\n", error->message.c_str());
    return 1;
  }
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  if (const auto error = net::write_file_atomically(path, stream.bytes)) {
    std::fprintf(stderr, "%s\n", error->message.c_str());
    return 1;
  }
  std::printf(
      "Made %.1f M vectors of %.1f M triangles in %.0f s, with %.1f GB of memory: %.1f MB, %.2f bits a vector.\n\n",
      static_cast<double>(stream.header.vectors) / 1e6, 12.0 * n * n / 1e6, seconds_since(start),
      peak_megabytes() / 1024, static_cast<double>(stream.bytes.size()) / 1e6,
      static_cast<double>(stream.bytes.size()) * 8 / static_cast<double>(stream.header.vectors));
  return 0;
}

/// Returns a view on the flight from far away to close above the ground, one and a half times around, looking down and
/// ahead.
qnv::LodView view_at(double t, const Box& box) {
  const float width = box.size().y / box.size().x;
  const double angle = 9.4 * t;
  const glm::vec3 direction = glm::normalize(glm::vec3(std::cos(angle), std::sin(angle), 0.3 + 0.4 * std::sin(3 * t)));
  const glm::vec3 ahead = glm::normalize(glm::vec3(std::cos(angle + 0.25), std::sin(angle + 0.25), direction.z));
  const glm::vec3 ground = surface_in(direction, width);
  const auto height = static_cast<float>(8 * std::pow(0.004 / 8, t));
  const glm::vec3 eye = ground + glm::normalize(ground) * height;
  const glm::vec3 target = glm::mix(glm::vec3(0), surface_in(ahead, width), static_cast<float>(std::min(1.0, 1.5 * t)));
  const glm::vec3 forward = glm::normalize(target - eye),
                  right = glm::normalize(glm::cross(forward, glm::vec3(0, 0, 1))), up = glm::cross(right, forward);
  constexpr float kTangent = 0.4142f, kWide = kTangent * 1920 / 1080;
  qnv::LodView view;
  view.eye = eye;
  view.pixels = 0.5f * 1080 / kTangent;
  const auto plane = [&](const glm::vec3& inwards) { return glm::vec4(inwards, -glm::dot(inwards, eye)); };
  view.planes = {plane(forward * kWide + right), plane(forward * kWide - right), plane(forward * kTangent + up),
                 plane(forward * kTangent - up), plane(forward)};
  view.leave_backs = true;
  return view;
}

struct Setting {
  const char* name;
  std::size_t most_decoded = 0, cache_bytes = qnv::LodStream::kCacheBytes;
  bool each_chunk = false, backs = false;
};

template <class Number>
Number ranked(std::vector<Number> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

int fly(const std::string& path, const Setting& setting, std::size_t budget, int frames) {
  const auto source = app::stream_source(path);
  if (!source) return 1;
  const auto start = Clock::now();
  auto opened = qnv::LodStream::open(source, setting.cache_bytes);
  if (const auto* problem = std::get_if<qnv::StreamProblem>(&opened)) {
    std::fprintf(stderr, "%s: %s\n", path.c_str(), problem->message.c_str());
    return 1;
  }
  const double opening = seconds_since(start), opening_memory = peak_megabytes();
  qnv::LodStream& stream = *std::get<std::unique_ptr<qnv::LodStream>>(opened);
  std::vector<double> times, processor;
  std::vector<std::size_t> decoded, pieces, discs;
  std::size_t cached = 0, all_decoded = 0;
  int pending = 0, after = 0;
  const auto frame = [&](double t) {
    qnv::LodView view = view_at(t, stream.header().description.box);
    view.budget = budget;
    view.most_decoded = setting.most_decoded;
    view.each_chunk = setting.each_chunk;
    view.leave_backs = !setting.backs;
    const auto before = Clock::now();
    const std::clock_t busy = std::clock();
    const auto drawn = stream.cut(view);
    times.push_back(seconds_since(before) * 1e3);
    processor.push_back(static_cast<double>(std::clock() - busy) * 1e3 / CLOCKS_PER_SEC);
    std::size_t sum = 0;
    for (const qnv::Piece& piece : drawn) sum += piece.count;
    discs.push_back(sum);
    pieces.push_back(drawn.size());
    decoded.push_back(stream.statistics().decoded);
    all_decoded += stream.statistics().decoded;
    cached = std::max(cached, stream.statistics().cached_bytes);
  };
  for (int i = 0; i < frames; ++i) {
    frame(i / std::max(1.0, frames - 1.0));
    pending += stream.pending() ? 1 : 0;
  }
  const auto flown = times;
  while (stream.pending() && after < 1000) {
    frame(1);
    ++after;
  }
  std::printf(
      "| %s | %.2f | %.1f | %.1f | %.1f | %.1f | %.2f | %.2f | %.2f | %zu | %zu | %d | %d | %.0f | %.0f | %.0f |\n",
      setting.name, opening, ranked(flown, 0.5), ranked(flown, 0.99), ranked(flown, 1), ranked(processor, 0.5),
      static_cast<double>(all_decoded) / 1e6, static_cast<double>(ranked(decoded, 1)) / 1e6,
      static_cast<double>(ranked(discs, 1)) / 1e6, ranked(pieces, 0.5), ranked(pieces, 1), pending, after,
      static_cast<double>(cached) / (1 << 20), peak_megabytes(), opening_memory);
  return stream.problems().empty() ? 0 : 1;
}

// Runs a function in a child process, to measure the function's memory.
int apart(const std::function<int()>& work) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child < 0) return 1;
  if (child == 0) {
    const int result = work();
    std::fflush(stdout);
    ::_exit(result);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

int run(double vectors, std::size_t budget, int frames, const std::string& folder) {
  char name[32];
  std::snprintf(name, sizeof name, "/lod_%g_million.qnv", vectors);
  const std::string path = folder + name;
  if (!std::filesystem::exists(path))
    if (const int failed = apart([&] { return make_stream(path, vectors * 1e6); })) return failed;
  std::printf("%s: %.1f MB\n\n", path.c_str(), static_cast<double>(std::filesystem::file_size(path)) / 1e6);
  std::printf(
      "| setting | opening, s | cut, ms: median | 99 %% | worst | of all processors, median | decoded, M | in one cut "
      "| discs drawn, M | pieces: "
      "median "
      "| most | frames with more to come | and after the flight | cache, MiB | peak memory, MiB | after opening |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  const Setting settings[] = {{"250 k a frame", 250'000},
                              {"all at once"},
                              {"250 k, cache of 64 MiB", 250'000, std::size_t{64} << 20},
                              {"250 k, each chunk a piece", 250'000, qnv::LodStream::kCacheBytes, true},
                              {"250 k, with what faces away", 250'000, qnv::LodStream::kCacheBytes, false, true}};
  int failed = 0;
  for (const Setting& setting : settings) failed |= apart([&] { return fly(path, setting, budget, frames); });
  return failed;
}

}  // namespace
}  // namespace gs::bench

int main(int argc, char** argv) {
  double vectors = 50, budget = 2;
  int frames = 200;
  std::string folder;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--vectors" && i + 1 < argc) {
      vectors = std::clamp(std::atof(argv[++i]), 0.01, 1000.0);
    } else if (argument == "--budget" && i + 1 < argc) {
      budget = std::clamp(std::atof(argv[++i]), 0.001, 1000.0);
    } else if (argument == "--frames" && i + 1 < argc) {
      frames = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--folder" && i + 1 < argc) {
      folder = argv[++i];
    } else {
      std::fprintf(stderr, "usage: lod_bench [--vectors MILLIONS] [--budget MILLIONS] [--frames N] [--folder DIR]\n");
      return 2;
    }
  }
  std::error_code error;
  const bool own = folder.empty();
  if (own) {
    folder = (std::filesystem::temp_directory_path() / "lod_bench_XXXXXX").string();
    if (!::mkdtemp(folder.data())) return 1;
  } else {
    std::filesystem::create_directories(folder, error);
  }
  const int result = gs::bench::run(vectors, static_cast<std::size_t>(budget * 1e6), frames, folder);
  if (own) std::filesystem::remove_all(folder, error);
  return result;
}
