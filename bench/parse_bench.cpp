// parse_bench [--runs N] [--markdown] [--processor] FILE...: compares the speed of the readers of VRML97 and X3D with
// the speed of memory.
//
// Each of N rounds runs in sequence: reading memory, the bare number loop, the parser with the whole text, and the
// parser with 64 KiB at a time. Prints medians of the elapsed seconds; with --processor, minima of the processor
// seconds, which other programs on the machine disturb less. Peak memory is that of child processes that only parse:
// `peak` reads the file into memory and parses it whole, `streamed` reads and parses 64 KiB at a time.

#include "base/diagnostic.h"
#include "bench/shared/bare_loop.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_reader.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <variant>
#include <vector>

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gs::bench {
namespace {

constexpr std::size_t kPiece = 64 * 1024;
constexpr double kMega = 1e6;

/// Prevents the removal of a result by optimisation.
volatile std::uint64_t sink;

std::optional<std::string> read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return std::nullopt;
  std::string text(static_cast<std::size_t>(in.tellg()), '\0');
  in.seekg(0);
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size()))) return std::nullopt;
  return text;
}

struct Parsed {
  std::unique_ptr<vrml::SceneGraph> scene;
  std::size_t errors = 0;
};

/// Returns the reader of a text in another grammar than VRML97, else null. The parser of VRML97 takes whole texts.
std::unique_ptr<vrml::SceneReader> reader_of(std::string_view text, vrml::SceneGraph& scene, Diagnostics& diagnostics) {
  const vrml::Grammar grammar = vrml::grammar_of(text.substr(0, 8192));
  return grammar == vrml::Grammar::vrml97 ? nullptr : vrml::make_reader(grammar, scene, diagnostics);
}

/// Parses a text in pieces, which `next_piece` returns until it returns an empty one.
template <class NextPiece>
Parsed parse_each(NextPiece&& next_piece) {
  Parsed parsed{std::make_unique<vrml::SceneGraph>("input"), 0};
  Diagnostics diagnostics;
  std::string_view piece = next_piece();
  const auto reader = vrml::make_reader(vrml::grammar_of(piece.substr(0, 8192)), *parsed.scene, diagnostics);
  for (; !piece.empty(); piece = next_piece()) reader->push(piece);
  reader->finish();
  parsed.errors = diagnostics.errors();
  return parsed;
}

Parsed parse_whole(std::string_view text) {
  Parsed parsed{std::make_unique<vrml::SceneGraph>("input"), 0};
  Diagnostics diagnostics;
  const auto reader = reader_of(text, *parsed.scene, diagnostics);
  if (reader) {
    reader->push(text);
    reader->finish();
  } else {
    vrml::parse(text, *parsed.scene, diagnostics);
  }
  parsed.errors = diagnostics.errors();
  return parsed;
}

Parsed parse_pieces(std::string_view text) {
  return parse_each([&] {
    const std::string_view piece = text.substr(0, kPiece);
    text.remove_prefix(piece.size());
    return piece;
  });
}

/// Parses a file without holding its whole text.
Parsed parse_streamed(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::vector<char> piece(kPiece);
  return parse_each([&] {
    in.read(piece.data(), kPiece);
    return std::string_view(piece.data(), static_cast<std::size_t>(in.gcount()));
  });
}

/// Returns the bytes of all multiple-valued fields of a scene, with shared storage counted once. A scene needs at least
/// this memory.
std::size_t array_bytes(const vrml::SceneGraph& scene) {
  std::unordered_set<const void*> seen;
  std::size_t bytes = 0;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Node& node = scene.nodes().at(i);
    for (const vrml::FieldValue& value : std::span(node.values, node.type->defaults.size())) {
      std::visit(
          [&](const auto& v) {
            if constexpr (requires { v.shares_with(v); }) {
              if (!v.empty() && seen.insert(v.data()).second) bytes += v.size() * sizeof(*v.data());
            }
          },
          value);
    }
  }
  return bytes;
}

/// Returns the peak resident bytes of a child process that runs `work`, or 0 on failure.
template <class Work>
std::size_t peak_of_child(Work&& work) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) return 0;
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (wait4(child, &status, 0, &usage) != child || status != 0) return 0;
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

bool processor_seconds = false;  // --processor

double now() {
  if (!processor_seconds)
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Work>
double seconds(Work&& work) {
  const double start = now();
  work();
  return now() - start;
}

// Returns the median, or with --processor the minimum.
double typical(std::vector<double> values) {
  if (processor_seconds) return *std::min_element(values.begin(), values.end());
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

struct Result {
  std::string name;
  std::size_t bytes = 0, numbers = 0, nodes = 0, errors = 0, arrays = 0;
  std::size_t peak = 0, streamed_peak = 0;
  double read = 0, bare = 0, whole = 0, pieces = 0;  // seconds
};

/// Measures memory while this process is still small, because a child starts with its parent's resident size.
Result measure_memory(const std::string& path) {
  Result result;
  result.name = path.substr(path.find_last_of('/') + 1);
  result.peak = peak_of_child([&] {
    const auto text = read_file(path);
    if (text) sink = parse_whole(*text).errors;
  });
  result.streamed_peak = peak_of_child([&] { sink = parse_streamed(path).errors; });
  return result;
}

bool measure_times(const std::string& path, int runs, Result& result) {
  const auto text = read_file(path);
  if (!text) return false;
  result.bytes = text->size();
  BareLoop bare(text->size());
  std::vector<double> read, number, whole, pieces;
  for (int run = 0; run < runs; ++run) {
    read.push_back(seconds([&] { sink = sum_words(*text); }));
    number.push_back(seconds([&] { result.numbers = bare.run(*text); }));
    const auto parse = [&](bool in_pieces) {
      malloc_trim(0);  // releases memory, as before a first world
      Parsed parsed;
      const double time = seconds([&] { parsed = in_pieces ? parse_pieces(*text) : parse_whole(*text); });
      (in_pieces ? pieces : whole).push_back(time);
      if (run > 0 || in_pieces) return;
      result.nodes = parsed.scene->nodes().count();
      result.errors = parsed.errors;
      result.arrays = array_bytes(*parsed.scene);
    };
    parse(run % 2 == 1);
    parse(run % 2 == 0);
  }
  result.read = typical(read);
  result.bare = typical(number);
  result.whole = typical(whole);
  result.pieces = typical(pieces);
  return true;
}

void print(const std::vector<Result>& results, bool markdown) {
  const char* const edge = markdown ? "| " : "";
  const char* const bar = markdown ? " | " : "  ";
  const auto row = [&](const std::vector<std::string>& cells) {
    std::string line = edge;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t width = i == 0 ? 16 : 10;
      if (cells[i].size() < width) line.append(i == 0 ? 0 : width - cells[i].size(), ' ');
      line += cells[i];
      if (i == 0 && cells[i].size() < width) line.append(width - cells[i].size(), ' ');
      if (i + 1 < cells.size()) line += bar;
    }
    std::printf("%s%s\n", line.c_str(), markdown ? " |" : "");
  };
  const auto fixed = [](double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return std::string(text);
  };
  row({"file", "MB", "numbers", "nodes", "errors", "read GB/s", "bare GB/s", "bare s", "whole GB/s", "whole s",
       "/ bare", "pieces s", "arrays MB", "peak MB", "streamed MB"});
  if (markdown) {
    std::printf("| --- ");
    for (int i = 1; i < 15; ++i) std::printf("| --: ");
    std::printf("|\n");
  }
  for (const Result& r : results) {
    const double size = static_cast<double>(r.bytes);
    row({r.name, fixed(size / kMega, 2), std::to_string(r.numbers), std::to_string(r.nodes), std::to_string(r.errors),
         fixed(size / r.read / 1e9, 1), fixed(size / r.bare / 1e9, 3), fixed(r.bare, 4), fixed(size / r.whole / 1e9, 3),
         fixed(r.whole, 4), fixed(r.whole / r.bare, 2), fixed(r.pieces, 4), fixed(r.arrays / kMega, 1),
         fixed(r.peak / kMega, 1), fixed(r.streamed_peak / kMega, 1)});
  }
}

int run(std::span<char*> arguments) {
  int runs = 5;
  bool markdown = false;
  std::vector<std::string> files;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view argument = arguments[i];
    if (argument == "--markdown") {
      markdown = true;
    } else if (argument == "--processor") {
      processor_seconds = true;
    } else if (argument == "--runs" && i + 1 < arguments.size()) {
      runs = std::max(1, std::atoi(arguments[++i]));
    } else {
      files.emplace_back(argument);
    }
  }
  if (files.empty()) {
    std::fputs("usage: parse_bench [--runs N] [--markdown] [--processor] FILE...\n", stderr);
    return 2;
  }
  std::vector<Result> results;
  for (const std::string& file : files) results.push_back(measure_memory(file));
  int status = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (measure_times(files[i], runs, results[i])) continue;
    std::fprintf(stderr, "parse_bench: cannot read %s\n", files[i].c_str());
    status = 1;
  }
  std::erase_if(results, [](const Result& r) { return r.bytes == 0; });
  print(results, markdown);
  return status;
}

}  // namespace
}  // namespace gs::bench

int main(int count, char** arguments) { return gs::bench::run(std::span(arguments + 1, arguments + count)); }
