// Measures the speed of the values codec, of one core and of two, beside zfp and JPEG XL in the same run.
//
//   values_bench FILE u8|u16|u16be X Y Z [--alone]
//
// FILE holds the voxels, x first. Prints Markdown tables: encoding, decoding of prefixes, vectors, and the time from
// the bytes of a prefix to the first vectors. Speeds count processor time, and the best of several rounds. Needs zfp,
// cjxl and djxl (Debian: zfp, libjxl-tools) in the PATH; `--alone` leaves them out. The programs also read and write
// files.
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/decode/cell_vectors.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace {

using namespace gs;

constexpr std::array<double, 5> kRates{0.1, 0.5, 1, 2, 4};  // bits a voxel

struct Voxels {
  qnv::VolumeLayout layout;
  std::string file;
  std::vector<std::byte> bytes;

  [[nodiscard]] double count() const { return static_cast<double>(qnv::voxel_count(layout)); }
  [[nodiscard]] qnv::VolumeSource source() const {
    return {layout, [this](std::uint32_t z, std::span<std::byte> to) {
              std::memcpy(to.data(), bytes.data() + z * to.size(), to.size());
              return true;
            }};
  }
};

/// Time of a task in seconds.
struct Cost {
  double wall = std::numeric_limits<double>::infinity(), processor = wall;
};

double processor_seconds(int who) {
  struct rusage usage {};
  ::getrusage(who, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

Cost cost_of(const std::function<void()>& task, int who = RUSAGE_SELF) {
  const double before = processor_seconds(who);
  const auto start = std::chrono::steady_clock::now();
  task();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), processor_seconds(who) - before};
}

// Returns the least cost of some rounds. `prepare` runs before each and does not count.
Cost least_cost(
    int rounds, const std::function<void()>& task, const std::function<void()>& prepare = [] {}) {
  Cost least;
  for (int i = 0; i < rounds; ++i) {
    prepare();
    const Cost one = cost_of(task);
    least = {std::min(least.wall, one.wall), std::min(least.processor, one.processor)};
  }
  return least;
}

// Lets the process run on the first `cores` of its processors. Parallel loops then have as many threads.
void use_cores(int cores) {
  static const cpu_set_t all = [] {
    cpu_set_t set;
    ::sched_getaffinity(0, sizeof set, &set);
    return set;
  }();
  cpu_set_t some;
  CPU_ZERO(&some);
  for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&some) < cores; ++i)
    if (CPU_ISSET(i, &all)) CPU_SET(i, &some);
  ::sched_setaffinity(0, sizeof some, &some);
}

qnv::EncodedStream encoded(const Voxels& voxels, std::size_t most_bytes, unsigned threads) {
  qnv::EncodeOptions options;
  options.tolerance.lossless = true;
  options.max_bytes = most_bytes;
  options.threads = threads;
  auto made = qnv::encode_values(voxels.source(), options);
  if (const auto* problem = std::get_if<qnv::EncodeError>(&made)) {
    std::fprintf(stderr, "values_bench: %s\n", problem->message.c_str());
    std::exit(1);
  }
  return std::move(std::get<qnv::EncodedStream>(made));
}

std::vector<qnv::values::Cluster> clusters_of(std::span<const std::byte> stream) {
  std::vector<qnv::values::Cluster> clusters;
  qnv::StreamReader reader;
  reader.push(stream, [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    if (type != qnv::ChunkType::values) return;
    if (auto cluster = qnv::values::parse_cluster(payload)) clusters.push_back(std::move(*cluster));
  });
  return clusters;
}

double speed(const Voxels& voxels, double seconds) { return voxels.count() / seconds / 1e6; }

void measure_encoding(const Voxels& voxels) {
  std::printf("\n| encoding | bits a voxel | M voxels/s a core | two threads, M voxels/s |\n|---|---:|---:|---:|\n");
  const auto row = [&](const char* name, std::size_t most_bytes) {
    std::size_t bytes = 0;
    use_cores(1);
    const Cost one = least_cost(3, [&] { bytes = encoded(voxels, most_bytes, 1).bytes.size(); });
    use_cores(2);
    const Cost two = least_cost(2, [&] { bytes = encoded(voxels, most_bytes, 2).bytes.size(); });
    std::printf("| %s | %.2f | %.1f | %.1f |\n", name, 8 * static_cast<double>(bytes) / voxels.count(),
                speed(voxels, one.processor), speed(voxels, two.wall));
  };
  for (const double rate : kRates) row("limited size", static_cast<std::size_t>(rate * voxels.count() / 8));
  row("lossless", 0);
}

void measure_decoding(const Voxels& voxels, const std::vector<std::byte>& stream) {
  std::printf(
      "\n| decoding: bits a voxel | coefficients | transform | both | two threads | vectors | two threads |\n"
      "|---:|---:|---:|---:|---:|---:|---:|\n");
  const qnv::values::Extent extent = voxels.layout.dimensions;
  std::vector<double> rates(kRates.begin(), kRates.end());
  rates.push_back(8 * static_cast<double>(stream.size()) / voxels.count());
  for (const double rate : rates) {
    const auto bytes = static_cast<std::size_t>(rate * voxels.count() / 8);
    if (bytes > stream.size()) continue;
    const std::vector<qnv::values::Cluster> clusters = clusters_of(std::span(stream).first(bytes));
    std::array<Cost, 3> parts;
    const auto measure = [&](int cores) {
      use_cores(cores);
      parts.fill({});
      for (int round = 0; round < 5; ++round) {
        qnv::values::ValuesDecoder decoder(extent);
        std::vector<qnv::values::SampleBox> changed;
        qnv::values::SampledGrid grid;
        qnv::VolumeLayout layout = voxels.layout;
        layout.type = qnv::VoxelType::i32;
        layout.big_endian = false;
        qnv::values::CellVectorOptions options{0.09, std::uint64_t{1} << 26, {0.0f, 3000.0f}};
        const std::array<Cost, 3> costs{cost_of([&] {
                                          for (const auto& cluster : clusters) decoder.add(cluster);
                                          decoder.decode_ready();
                                        }),
                                        cost_of([&] {
                                          grid = {decoder.bricks(0, changed), layout, nullptr};
                                        }),
                                        cost_of([&] {
                                          qnv::values::CellVectors vectors(extent, glm::dmat3(1), options);
                                          vectors.update(grid, changed);
                                          qnv::Volume volume((qnv::GeometryBase()));
                                          vectors.fill(grid, volume);
                                        })};
        for (std::size_t i = 0; i < parts.size(); ++i)
          parts[i] = {std::min(parts[i].wall, costs[i].wall), std::min(parts[i].processor, costs[i].processor)};
      }
    };
    measure(2);
    const double both_wall = parts[0].wall + parts[1].wall, vectors_wall = parts[2].wall;
    measure(1);
    std::printf("| %.2f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n", rate, speed(voxels, parts[0].processor),
                speed(voxels, parts[1].processor), speed(voxels, parts[0].processor + parts[1].processor),
                speed(voxels, both_wall), speed(voxels, parts[2].processor), speed(voxels, vectors_wall));
  }
}

void measure_first_picture(const std::vector<std::byte>& stream) {
  std::printf("\n| first picture from | ms | two threads, ms | vectors | level |\n|---:|---:|---:|---:|---:|\n");
  for (const std::size_t bytes : {std::size_t{8000}, std::size_t{15'000}, std::size_t{46'000}, std::size_t{125'000}}) {
    if (bytes > stream.size()) continue;
    std::size_t vectors = 0;
    int level = 0;
    const auto decode = [&] {
      qnv::StreamDecoder decoder;
      decoder.push(std::span(stream).first(bytes));
      const qnv::Geometry geometry = decoder.geometry();
      const auto* volume = geometry.as<qnv::Volume>();
      vectors = volume ? volume->positions.size() : 0;
      level = volume && volume->values ? volume->values->level : -1;
    };
    use_cores(2);
    const Cost two = least_cost(5, decode);
    use_cores(1);
    const Cost one = least_cost(5, decode);
    std::printf("| %zu | %.1f | %.1f | %zu | %d |\n", bytes, 1e3 * one.processor, 1e3 * two.wall, vectors, level);
  }
}

// Runs a command. Returns its processor time, or infinity if it fails.
double program_seconds(const std::string& command) {
  int status = -1;
  const Cost cost = cost_of([&] { status = std::system((command + " >/dev/null 2>&1").c_str()); }, RUSAGE_CHILDREN);
  return status == 0 ? cost.processor : std::numeric_limits<double>::infinity();
}

void write_file(const std::string& path, const void* data, std::size_t bytes) {
  std::ofstream(path, std::ios::binary).write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
}
std::size_t size_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  return in ? static_cast<std::size_t>(in.tellg()) : 0;
}

// Voxels as integers, for the other programs.
std::vector<std::uint16_t> numbers_of(const Voxels& voxels) {
  const auto count = static_cast<std::size_t>(voxels.count());
  std::vector<std::uint16_t> numbers(count);
  const auto* from = reinterpret_cast<const std::uint8_t*>(voxels.bytes.data());
  for (std::size_t i = 0; i < count; ++i)
    numbers[i] = voxels.layout.type == qnv::VoxelType::u8 ? from[i]
                 : voxels.layout.big_endian ? static_cast<std::uint16_t>(from[2 * i] << 8 | from[2 * i + 1])
                                            : static_cast<std::uint16_t>(from[2 * i + 1] << 8 | from[2 * i]);
  return numbers;
}

void measure_others(const Voxels& voxels, const std::string& folder) {
  std::printf(
      "\n| other program | bits a voxel | encoding, M voxels/s | decoding, M voxels/s |\n|---|---:|---:|---:|\n");
  const std::vector<std::uint16_t> numbers = numbers_of(voxels);
  const auto [nx, ny, nz] = voxels.layout.dimensions;
  const auto row = [&](const std::string& name, const std::string& encode, const std::string& decode,
                       const std::string& packed) {
    double encoding = std::numeric_limits<double>::infinity(), decoding = encoding;
    for (int i = 0; i < 3; ++i) {
      encoding = std::min(encoding, program_seconds(encode));
      decoding = std::min(decoding, program_seconds(decode));
    }
    if (encoding < 1e9)
      std::printf("| %s | %.2f | %.1f | %.1f |\n", name.c_str(),
                  8 * static_cast<double>(size_of_file(packed)) / voxels.count(), speed(voxels, encoding),
                  speed(voxels, decoding));
  };
  const std::vector<float> floats(numbers.begin(), numbers.end());
  const std::string base = folder + "/volume";
  write_file(base + ".f32", floats.data(), floats.size() * sizeof(float));
  const std::string shape = " -f -3 " + std::to_string(nx) + " " + std::to_string(ny) + " " + std::to_string(nz);
  const auto zfp = [&](const std::string& how) {
    row("zfp" + how, "zfp -q -i " + base + ".f32 -z " + base + ".zfp" + shape + how,
        "zfp -q -z " + base + ".zfp -o " + base + ".out" + shape + how, base + ".zfp");
  };
  for (const char* const rate : {" -r 0.5", " -r 1", " -r 2", " -r 4", " -R"}) zfp(rate);
  // All slices in one grey image, one below the other, with 16 bits.
  std::string image = "P5\n" + std::to_string(nx) + " " + std::to_string(std::size_t{ny} * nz) + "\n65535\n";
  for (const std::uint16_t number : numbers) {
    image += static_cast<char>(number >> 8);
    image += static_cast<char>(number & 255);
  }
  write_file(base + ".pgm", image.data(), image.size());
  const auto jxl = [&](const std::string& how) {
    row("JPEG XL" + how, "cjxl " + base + ".pgm " + base + ".jxl --num_threads=1" + how,
        "djxl " + base + ".jxl " + base + ".out.pgm --num_threads=1", base + ".jxl");
  };
  for (const char* const how : {" -d 1 -e 3", " -d 0 -e 1", " -d 0 -e 3"}) jxl(how);
  for (const char* const ending : {".f32", ".zfp", ".out", ".pgm", ".jxl", ".out.pgm"})
    ::unlink((base + ending).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: values_bench FILE u8|u16|u16be X Y Z [--alone]\n");
    return 2;
  }
  Voxels voxels;
  voxels.file = argv[1];
  const std::string type = argv[2];
  voxels.layout.type = type == "u8" ? qnv::VoxelType::u8 : qnv::VoxelType::u16;
  voxels.layout.big_endian = type == "u16be";
  for (int a = 0; a < 3; ++a)
    voxels.layout.dimensions[static_cast<std::size_t>(a)] =
        static_cast<std::uint32_t>(std::strtoul(argv[3 + a], nullptr, 10));
  std::ifstream in(voxels.file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  voxels.bytes.resize(qnv::voxel_count(voxels.layout) * qnv::size_of(voxels.layout.type));
  if (content.size() < voxels.bytes.size() || voxels.bytes.empty()) {
    std::fprintf(stderr, "values_bench: %s has %zu bytes; expected at least %zu\n", argv[1], content.size(),
                 voxels.bytes.size());
    return 1;
  }
  std::memcpy(voxels.bytes.data(), content.data(), voxels.bytes.size());
  const std::vector<std::byte> stream = encoded(voxels, 0, 2).bytes;
  const std::string_view text(reinterpret_cast<const char*>(stream.data()), stream.size());
  std::printf("%s: %zu bytes, hash %016zx\n", argv[1], stream.size(), std::hash<std::string_view>()(text));
  std::fflush(stdout);
  measure_decoding(voxels, stream);
  std::fflush(stdout);
  measure_first_picture(stream);
  measure_encoding(voxels);
  if (argc > 6 && std::string(argv[6]) == "--alone") return 0;
  std::string folder = "/tmp/values_bench.XXXXXX";
  if (!::mkdtemp(folder.data())) return 1;
  measure_others(voxels, folder);
  ::rmdir(folder.c_str());
  return 0;
}
