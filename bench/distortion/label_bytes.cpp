// Compares bytes of label volumes: QNV, gzip, zstd, xz and lossless JPEG XL slices.
//
//   label_bytes VOLUME... [--thresholds A,B,...] [--smooth N] [--components]
//
// Prints a Markdown table: the bytes of each format, and for QNV the bytes of each level, the time of encoding and of
// decoding, and the share of wrong labels at several sizes. A volume without labels becomes one: `--smooth N` applies N
// box filters of three voxels per axis; the label is the number of thresholds below the value; with `--components`,
// each connected part has a label of its own. Needs gzip, zstd, xz and cjxl (Debian: libjxl-tools) in the PATH; without
// them their columns are empty.
#include "app/formats/volume/volume.h"
#include "qnv/codecs/values/labels/encode/label_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace gs;

struct Labels {
  std::array<std::uint32_t, 3> size{};
  std::vector<std::uint32_t> labels;
  [[nodiscard]] std::size_t at(std::size_t x, std::size_t y, std::size_t z) const {
    return (z * size[1] + y) * size[0] + x;
  }
};

std::vector<float> smoothed(const Labels& grid, const std::vector<float>& values) {
  std::vector<float> out(values.size());
  for (std::size_t z = 0; z < grid.size[2]; ++z)
    for (std::size_t y = 0; y < grid.size[1]; ++y)
      for (std::size_t x = 0; x < grid.size[0]; ++x) {
        float sum = 0;
        int count = 0;
        for (std::size_t k = z > 0 ? z - 1 : 0; k < std::min<std::size_t>(z + 2, grid.size[2]); ++k)
          for (std::size_t j = y > 0 ? y - 1 : 0; j < std::min<std::size_t>(y + 2, grid.size[1]); ++j)
            for (std::size_t i = x > 0 ? x - 1 : 0; i < std::min<std::size_t>(x + 2, grid.size[0]); ++i) {
              sum += values[grid.at(i, j, k)];
              ++count;
            }
        out[grid.at(x, y, z)] = sum / static_cast<float>(count);
      }
  return out;
}

// Gives each connected part of equal labels its own label.
void part(Labels& grid) {
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> parts(grid.labels.size(), kNone);
  std::vector<std::size_t> open;
  std::uint32_t next = 0;
  for (std::size_t start = 0; start < parts.size(); ++start) {
    if (parts[start] != kNone) continue;
    parts[start] = next;
    open.push_back(start);
    while (!open.empty()) {
      const std::size_t i = open.back(), x = i % grid.size[0], y = i / grid.size[0] % grid.size[1],
                        z = i / grid.size[0] / grid.size[1];
      open.pop_back();
      const auto visit = [&](bool inside, std::size_t j) {
        if (!inside || parts[j] != kNone || grid.labels[j] != grid.labels[i]) return;
        parts[j] = next;
        open.push_back(j);
      };
      const std::size_t row = grid.size[0], slice = row * grid.size[1];
      visit(x > 0, i - 1);
      visit(x + 1 < grid.size[0], i + 1);
      visit(y > 0, i - row);
      visit(y + 1 < grid.size[1], i + row);
      visit(z > 0, i - slice);
      visit(z + 1 < grid.size[2], i + slice);
    }
    ++next;
  }
  grid.labels = std::move(parts);
}

struct Wish {
  std::vector<float> thresholds;
  int smooth = 0;
  bool components = false;
};

Labels labels_of(const qnv::VolumeSource& source, const Wish& wish) {
  Labels grid{source.layout.dimensions, {}};
  std::vector<float> values(qnv::voxel_count(source.layout));
  std::vector<std::byte> scratch;
  const std::size_t slice = qnv::slice_voxels(source.layout);
  for (std::uint32_t z = 0; z < grid.size[2]; ++z)
    (void)qnv::read_slice(source, z, scratch, std::span(values).subspan(z * slice, slice));
  for (int i = 0; i < wish.smooth; ++i) values = smoothed(grid, values);
  for (const float value : values) {
    if (wish.thresholds.empty())
      grid.labels.push_back(static_cast<std::uint32_t>(value));
    else
      grid.labels.push_back(static_cast<std::uint32_t>(
          std::ranges::count_if(wish.thresholds, [&](float threshold) { return value > threshold; })));
  }
  if (wish.components) part(grid);
  return grid;
}

// Runs a program. Returns the size of the file that it writes, or 0.
std::size_t bytes_by(const std::string& command, const std::string& out) {
  std::error_code error;
  std::filesystem::remove(out, error);
  if (std::system((command + " >/dev/null 2>&1").c_str()) != 0) return 0;
  const auto size = std::filesystem::file_size(out, error);
  return error ? 0 : static_cast<std::size_t>(size);
}

void write_file(const std::string& path, const std::string& head, std::span<const char> body) {
  std::ofstream out(path, std::ios::binary);
  out.write(head.data(), static_cast<std::streamsize>(head.size()));
  out.write(body.data(), static_cast<std::streamsize>(body.size()));
}

// Returns labels as bytes, or as numbers of 16 bits.
std::vector<char> packed(std::span<const std::uint32_t> labels, bool wide, bool big_endian) {
  std::vector<char> out;
  for (const std::uint32_t label : labels) {
    const char low = static_cast<char>(label & 255), high = static_cast<char>(label >> 8 & 255);
    if (wide && big_endian) out.push_back(high);
    out.push_back(low);
    if (wide && !big_endian) out.push_back(high);
  }
  return out;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void compare(const std::string& name, const Labels& grid, const std::string& base) {
  const std::uint32_t most = *std::ranges::max_element(grid.labels);
  const bool wide = most > 255;
  write_file(base + ".raw", {}, packed(grid.labels, wide, false));
  const std::size_t gzip = bytes_by("{ gzip -9c " + base + ".raw > " + base + ".gz; }", base + ".gz"),
                    zstd = bytes_by("zstd -19 -f -o " + base + ".zst " + base + ".raw", base + ".zst"),
                    xz = bytes_by("{ xz -9ekc " + base + ".raw > " + base + ".xz; }", base + ".xz");
  std::size_t jxl = 0;
  const std::size_t slice = std::size_t{grid.size[0]} * grid.size[1];
  for (std::uint32_t z = 0; z < grid.size[2]; ++z) {
    const std::string head = "P5\n" + std::to_string(grid.size[0]) + " " + std::to_string(grid.size[1]) + "\n" +
                             (wide ? "65535\n" : "255\n");
    write_file(base + ".pgm", head, packed(std::span(grid.labels).subspan(z * slice, slice), wide, true));
    jxl += bytes_by("cjxl -d 0 -e 7 " + base + ".pgm " + base + ".jxl", base + ".jxl");
  }
  qnv::VolumeSource source;
  source.layout.dimensions = grid.size;
  source.layout.type = qnv::VoxelType::u32;
  source.layout.labels = true;
  source.read = [&](std::uint32_t z, std::span<std::byte> to) {
    std::memcpy(to.data(), grid.labels.data() + z * slice, to.size());
    return true;
  };
  const auto encoding = std::chrono::steady_clock::now();
  const auto encoded = qnv::encode_labels(source, {});
  const double encode_seconds = seconds_since(encoding);
  const auto* stream = std::get_if<qnv::EncodedStream>(&encoded);
  if (!stream) return;
  const auto decoding = std::chrono::steady_clock::now();
  qnv::StreamDecoder decoder;
  (void)decoder.push(stream->bytes);
  const double decode_seconds = seconds_since(decoding);
  const double voxels = static_cast<double>(grid.labels.size()) / 1e6;
  std::printf("| %s | %u | %zu | %zu | %zu | %zu | %zu | %.1f | %.1f |\n", name.c_str(), most + 1, gzip, zstd, xz, jxl,
              stream->bytes.size(), voxels / encode_seconds, voxels / decode_seconds);
  std::map<int, std::size_t> levels;
  std::size_t arrived = 0;
  std::uint32_t chunks = 0;
  std::string shares;
  qnv::StreamReader reader;
  (void)reader.push(stream->bytes, [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    arrived += payload.size() + qnv::kChunkHeaderBytes;
    if (type != qnv::ChunkType::labels) return;
    levels[std::to_integer<int>(payload.front())] += payload.size();
    ++chunks;
    for (const qnv::ValueError& error : stream->header.grid.errors)
      if (error.chunks == chunks) {
        char text[64];
        std::snprintf(text, sizeof text, " %zu: %.3f %%;", arrived, 100 * static_cast<double>(error.most));
        shares += text;
      }
  });
  std::printf("\nwrong labels after bytes:%s\nbytes of levels:", shares.c_str());
  for (const auto& [level, bytes] : levels) std::printf(" %d: %zu;", level, bytes);
  std::printf("\n\n");
}

}  // namespace

int main(int count, char** arguments) {
  Wish wish;
  std::vector<std::string> files;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    if (argument == "--components") {
      wish.components = true;
    } else if (argument == "--smooth" && i + 1 < count) {
      wish.smooth = std::atoi(arguments[++i]);
    } else if (argument == "--thresholds" && i + 1 < count) {
      for (const char* at = arguments[++i]; *at != '\0'; at += *at == ',' ? 1 : 0) {
        char* end = nullptr;
        wish.thresholds.push_back(std::strtof(at, &end));
        if (end == at) break;
        at = end;
      }
    } else {
      files.push_back(argument);
    }
  }
  if (files.empty()) {
    std::fprintf(stderr, "usage: label_bytes VOLUME... [--thresholds A,B,...] [--smooth N] [--components]\n");
    return 2;
  }
  const std::string base =
      (std::filesystem::temp_directory_path() / ("label_bytes." + std::to_string(getpid()))).string();
  std::printf("| volume | labels | gzip -9 | zstd -19 | xz -9e | JPEG XL slices | QNV | encode M/s | decode M/s |\n");
  std::printf("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const std::string& file : files) {
    auto opened = app::open_volume(file);
    if (const auto* problem = std::get_if<std::string>(&opened)) {
      std::fprintf(stderr, "%s\n", problem->c_str());
      return 1;
    }
    compare(std::filesystem::path(file).filename().string(), labels_of(std::get<qnv::VolumeSource>(opened), wish),
            base);
  }
  for (const char* const ending : {".raw", ".gz", ".zst", ".xz", ".pgm", ".jxl"})
    std::filesystem::remove(base + ending);
  return 0;
}
