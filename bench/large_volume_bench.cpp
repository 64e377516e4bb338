// Encodes volumes that may be larger than memory, and prints speed and peak memory.
//
//   large_volume_bench FOLDER [--lossless | --error E] X Y Z [X Y Z ...]
//
// Each volume is a turbulent field of 16 bits, which is written to FOLDER first. A process of its own encodes it, and
// another one restores all slices from the stream. FOLDER needs room for the volume and twice its stream.

#include "app/encode/encode_spill.h"
#include "app/encode/file_sink.h"
#include "base/parallel.h"
#include "net/files/atomic_file.h"
#include "net/files/file.h"
#include "qnv/codecs/values/decode/values_slices.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using namespace gs;

constexpr std::size_t kSpillBytes = std::size_t{64} << 20;

struct Task {
  std::string folder;
  qnv::EncodeOptions options;
  std::array<std::uint32_t, 3> size{};

  [[nodiscard]] std::string volume() const { return folder + "/volume.raw"; }
  [[nodiscard]] std::string stream() const { return folder + "/volume.qnv"; }
  [[nodiscard]] double voxels() const { return static_cast<double>(size[0]) * size[1] * size[2]; }
};

std::uint32_t hash_of(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ z * 0xc2b2ae3du;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  return h ^ h >> 15;
}

// Smoothed noise with an edge length of 2^shift voxels.
float noise_at(std::uint32_t x, std::uint32_t y, std::uint32_t z, int shift) {
  const auto part = [&](std::uint32_t v) {
    const float t = static_cast<float>(v & ((1u << shift) - 1)) / static_cast<float>(1u << shift);
    return t * t * (3 - 2 * t);
  };
  const float u = part(x), v = part(y), w = part(z);
  float sum = 0;
  for (unsigned c = 0; c < 8; ++c) {
    const float weight = ((c & 1) != 0 ? u : 1 - u) * ((c & 2) != 0 ? v : 1 - v) * ((c & 4) != 0 ? w : 1 - w);
    sum +=
        weight *
        static_cast<float>(hash_of((x >> shift) + (c & 1), (y >> shift) + (c >> 1 & 1), (z >> shift) + (c >> 2)) >> 8) /
        16777216.0f;
  }
  return sum;
}

// Writes octaves of noise with the spectrum of turbulence, and a little noise of the instrument. The slices repeat
// after kPeriod, which no part of the encoder notices.
bool make_volume(const Task& task) {
  constexpr std::uint32_t kPeriod = 128;
  constexpr std::array<float, 5> kWeights{20'000, 9000, 4050, 1822, 820};
  auto begun = net::AtomicFile::begin(task.volume());
  auto* file = std::get_if<net::AtomicFile>(&begun);
  if (!file) return false;
  const auto [nx, ny, nz] = task.size;
  std::vector<std::vector<std::uint16_t>> slices;
  for (std::uint32_t z = 0; z < nz; ++z) {
    if (z < kPeriod) {
      auto& slice = slices.emplace_back(std::size_t{nx} * ny);
      (void)parallel_for(ny, [&, nx = nx](std::size_t row) {
        const auto y = static_cast<std::uint32_t>(row);
        for (std::uint32_t x = 0; x < nx; ++x) {
          float value = static_cast<float>(hash_of(x, y, z) % 16);
          for (std::size_t octave = 0; octave < kWeights.size(); ++octave)
            value += kWeights[octave] * noise_at(x, y, z, 7 - static_cast<int>(octave));
          slice[row * nx + x] = static_cast<std::uint16_t>(value);
        }
      });
    }
    if (!file->write(std::as_bytes(std::span(slices[z % kPeriod])))) return false;
  }
  return !file->commit();
}

qnv::VolumeSource source_of(const Task& task) {
  qnv::VolumeSource source;
  source.layout.dimensions = task.size;
  source.layout.type = qnv::VoxelType::u16;
  auto opened = net::open_file(task.volume());
  if (auto* file = std::get_if<net::RandomAccessFile>(&opened)) {
    const auto shared = std::make_shared<net::RandomAccessFile>(std::move(*file));
    source.read = [shared](std::uint32_t z, std::span<std::byte> to) {
      return shared->read(std::uint64_t{z} * to.size(), to) == to.size();
    };
  }
  return source;
}

bool encode(const Task& task) {
  auto begun = net::AtomicFile::begin(task.stream());
  auto* file = std::get_if<net::AtomicFile>(&begun);
  if (!file) return false;
  app::EncodeSpill spill(kSpillBytes, task.folder);
  qnv::EncodeOptions options = task.options;
  options.spill = &spill;
  app::FileSink sink(*file);
  options.sink = &sink;
  const auto encoded = qnv::encode_values(source_of(task), options);
  if (const auto* problem = std::get_if<qnv::EncodeError>(&encoded)) {
    std::fprintf(stderr, "%s\n", problem->message.c_str());
    return false;
  }
  return !file->commit();
}

bool decode(const Task& task) {
  auto opened = net::open_file(task.stream());
  auto* file = std::get_if<net::RandomAccessFile>(&opened);
  if (!file) return false;
  auto slices = qnv::open_values_slices({file->size(), [&](std::uint64_t offset, std::span<std::byte> to) {
                                           return file->read(offset, to) == to.size();
                                         }});
  const auto* values = std::get_if<std::shared_ptr<const qnv::VolumeValues>>(&slices);
  if (!values) return false;
  const qnv::VolumeSource truth = source_of(task);
  std::vector<std::byte> scratch;
  std::vector<float> decoded(std::size_t{task.size[0]} * task.size[1]), expected(decoded.size());
  double most = 0;
  for (std::uint32_t z = 0; z < task.size[2]; ++z) {
    if (!qnv::read_slice((*values)->source, z, scratch, decoded) || !qnv::read_slice(truth, z, scratch, expected))
      return false;
    for (std::size_t i = 0; i < decoded.size(); ++i)
      most = std::max(most, static_cast<double>(std::abs(decoded[i] - expected[i])));
  }
  std::printf("  greatest error %g, stated %g\n", most, static_cast<double>((*values)->error.value_or(-1)));
  return true;
}

// Runs a step in a process of its own. Prints its speed and its peak memory.
bool measured(const char* name, const Task& task, const std::function<bool(const Task&)>& step) {
  std::fflush(stdout);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = ::fork();
  if (child == 0) {
    const bool good = step(task);
    std::fflush(stdout);
    ::_exit(good ? 0 : 1);
  }
  int status = 0;
  struct rusage usage {};
  if (child < 0 || ::wait4(child, &status, 0, &usage) < 0 || status != 0) return false;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  const double cpu = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                     1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  std::printf("  %s: %.1f s, %.1f M voxels/s, %.1f M voxels/s of a core, peak memory %.0f MB\n", name, took.count(),
              task.voxels() / took.count() / 1e6, task.voxels() / cpu / 1e6,
              static_cast<double>(usage.ru_maxrss) * 1024 / 1e6);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: large_volume_bench FOLDER [--lossless | --error E] X Y Z [X Y Z ...]\n");
    return 2;
  }
  Task task;
  task.folder = argv[1];
  int at = 2;
  if (std::strcmp(argv[at], "--lossless") == 0) {
    task.options.tolerance.lossless = true;
    ++at;
  } else if (std::strcmp(argv[at], "--error") == 0) {
    task.options.tolerance.error = std::strtod(argv[at + 1], nullptr);
    at += 2;
  }
  for (; at + 2 < argc; at += 3) {
    for (int a = 0; a < 3; ++a)
      task.size[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(std::strtoul(argv[at + a], nullptr, 10));
    std::printf("%u x %u x %u\n", task.size[0], task.size[1], task.size[2]);
    if (!make_volume(task) || !measured("encode", task, encode) || !measured("decode", task, decode)) return 1;
    std::printf(
        "  %.3f bits a voxel\n",
        8 * static_cast<double>(std::get<net::RandomAccessFile>(net::open_file(task.stream())).size()) / task.voxels());
  }
  return 0;
}
