// record_bench [--vectors N] [--runs R] [--markdown]: compares unpacking and packing of 8-byte records with memcpy.
//
// Uses one core. Each of R rounds runs in sequence: memcpy of as many bytes as unpacking moves, every path of
// unpacking, and packing. Prints medians. Bytes are those read plus those written: 8 + 29 per vector (12 position, 12
// normal, 4 weight, 1 colour), and twice each byte for memcpy. Memory is touched before the clock starts.

#include "qnv/codecs/records/record.h"
#include "qnv/codecs/records/record_paths.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::bench {
namespace {

namespace paths = qnv::record_paths;

constexpr std::size_t kMovedBytes = 8 + 29;  // per vector, read and written

struct Arrays {
  explicit Arrays(std::size_t count)
      : records(count * qnv::kRecordBytes), positions(count), normals(count), weights(count), colors(count) {
    std::uint64_t state = 1;
    for (std::size_t i = 0; i < count; ++i) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const std::uint64_t bits = state ^ state >> 29;
      std::memcpy(&records[i * qnv::kRecordBytes], &bits, sizeof bits);
    }
  }
  std::vector<std::byte> records;
  std::vector<glm::vec3> positions, normals;
  std::vector<float> weights;
  std::vector<std::uint8_t> colors;
};

struct Row {
  std::string name;
  std::size_t bytes_per_vector = kMovedBytes;
  std::function<void()> work;
  std::vector<double> seconds = {};
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(std::size_t count, int runs, bool markdown) {
  Arrays a(count);
  const std::size_t half = count * kMovedBytes / 2;  // memcpy moves each byte twice
  std::vector<std::byte> from(half, std::byte{1}), to(half);
  const qnv::RecordFrame frame = qnv::frame_for({{-1, -2, -3}, {1, 2, 3}}, 5);
  const paths::Outputs out{a.positions.data(), a.normals.data(), a.weights.data(), a.colors.data()};
  const std::byte* const records = a.records.data();
  std::vector<Row> rows{{"memcpy", kMovedBytes, [&] { std::memcpy(to.data(), from.data(), half); }}};
  rows.push_back({"unpack", kMovedBytes,
                  [&] { qnv::unpack_records(a.records, frame, out.positions, out.normals, out.weights, out.colors); }});
  rows.push_back({"unpack, portable", kMovedBytes, [&] { paths::unpack_portable(records, count, frame, out); }});
  if (paths::has_avx2())
    rows.push_back({"unpack, AVX2", kMovedBytes, [&] { paths::unpack_avx2(records, count, frame, out); }});
  rows.push_back({"pack", kMovedBytes,
                  [&] { qnv::pack_records(a.positions, a.normals, a.weights, a.colors, frame, a.records.data()); }});
  for (int run = 0; run < runs; ++run) {
    for (Row& row : rows) {
      const auto start = std::chrono::steady_clock::now();
      row.work();
      row.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  }
  const double copy = static_cast<double>(count * kMovedBytes) / median(rows.front().seconds);
  std::printf(markdown ? "\n%zu vectors (%.0f MB moved), medians of %d\n\n| | GB/s | of memcpy | M vectors/s |\n| --- "
                         "| --- | --- | --- |\n"
                       : "%zu vectors (%.0f MB moved), medians of %d: GB/s, of memcpy, M vectors/s\n",
              count, static_cast<double>(count * kMovedBytes) / 1e6, runs);
  for (const Row& row : rows) {
    const double seconds = median(row.seconds), rate = static_cast<double>(count * row.bytes_per_vector) / seconds;
    std::printf(markdown ? "| %s | %.2f | %.2f | %.0f |\n" : "  %-26s %7.2f %6.2f %8.0f\n", row.name.c_str(),
                rate / 1e9, rate / copy, static_cast<double>(count) / seconds / 1e6);
  }
}

}  // namespace
}  // namespace gs::bench

int main(int argc, char** argv) {
  std::vector<std::size_t> counts{2'000, 200'000, 24'000'000};
  int runs = 9;
  bool markdown = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--markdown") {
      markdown = true;
    } else if (argument == "--vectors" && i + 1 < argc) {
      counts = {static_cast<std::size_t>(std::max(1ll, std::atoll(argv[++i])))};
    } else if (argument == "--runs" && i + 1 < argc) {
      runs = std::max(1, std::atoi(argv[++i]));
    } else {
      std::fprintf(stderr, "usage: record_bench [--vectors N] [--runs R] [--markdown]\n");
      return 2;
    }
  }
  for (const std::size_t count : counts) gs::bench::measure(count, runs, markdown);
  return 0;
}
