// stream_mutations COUNT SEED FIRST KEPT NUMBER FOLDER...: makes the mutations FIRST to COUNT - 1 of the streams
// (*.qnv) in the folders, and passes each to the targets of qnv. A seed and a number always give the same mutation.
//
// Unlike libFuzzer, it uses the structure of the container (FORMAT.md). It changes, inserts, deletes and repeats bytes
// of one section or payload. It repeats, moves, drops and swaps chunks. It takes chunks and halves of payloads from
// other streams, and forges lengths. It corrects the checksums of seven in eight mutations.
//
// It writes each input to the file KEPT, and its number to the file NUMBER, before the input is read. If the program
// ends, these files name the cause. It prints one line per thousand inputs, and a table at the end.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/stream_bytes.h"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>

namespace gs::fuzz {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kMaxBytes = 24576;  // bytes of a mutation; longer ones are slower and find no more faults
constexpr int kMaxSeconds = 10;  // maximum processor seconds for one input
constexpr double kLongSeconds = 1;  // longer inputs are reported
// Smaller streams are mutated kSmallTurns times as often, because larger ones take about five times as long.
constexpr std::size_t kSmallBytes = 7168, kSmallTurns = 6;

/// Section of the header, or chunk: its kind and its bytes.
struct Part {
  std::uint16_t type = 0;
  Bytes bytes;
};

struct SeedStream {
  std::string name;
  std::size_t size = 0;
  Bytes fixed;  // header without its sections
  std::vector<Part> sections, chunks;
};

/// Splits a stream into parts. If the stream is invalid, follows its lengths as far as possible.
SeedStream parts_of(const Bytes& bytes, std::string name) {
  SeedStream stream;
  stream.name = std::move(name);
  stream.size = bytes.size();
  if (bytes.size() < kFixedHeader) return stream;
  const auto at = [&](std::size_t from, std::size_t count) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(from);
    return Bytes(first, first + static_cast<std::ptrdiff_t>(count));
  };
  stream.fixed = at(0, kFixedHeader);
  const std::size_t header = std::min<std::size_t>(number_at(bytes, kHeaderLength, 4), bytes.size());
  for (std::size_t i = kFixedHeader; i + kSectionHead <= header;) {
    const std::size_t size = std::min<std::size_t>(number_at(bytes, i + 2, 4), header - i - kSectionHead);
    stream.sections.push_back({static_cast<std::uint16_t>(number_at(bytes, i, 2)), at(i + kSectionHead, size)});
    i += kSectionHead + size;
  }
  for (std::size_t i = std::max(header, kFixedHeader); i + kChunkHead <= bytes.size();) {
    const std::size_t size = std::min<std::size_t>(number_at(bytes, i + 2, 2), bytes.size() - i - kChunkHead);
    stream.chunks.push_back({bytes[i + 4], at(i + kChunkHead, size)});
    i += kChunkHead + size;
  }
  return stream;
}

class Mutator {
 public:
  Mutator(const std::vector<SeedStream>& streams, std::uint64_t seed) : streams_(streams), random_(seed) {}

  Bytes mutated(std::size_t from) {
    SeedStream stream = streams_[from];
    const std::size_t times = 1 + below(4);
    for (std::size_t i = 0; i < times; ++i) change(stream);
    Bytes bytes = joined(stream);
    if (below(6) == 0) forge(bytes);
    if (below(8) == 0) bytes.resize(below(bytes.size() + 1));
    if (below(8) != 0) mend_checksums(bytes);
    if (below(16) == 0) change_bytes(bytes);
    bytes.resize(std::min(bytes.size(), kMaxBytes));
    return bytes;
  }

 private:
  std::size_t below(std::size_t most) { return most == 0 ? 0 : random_() % most; }

  /// Returns a number that often causes faults in readers, such as a boundary value.
  std::uint32_t telling_number() {
    constexpr std::array<std::uint32_t, 14> kNumbers{
        0, 1, 2, 0x7f, 0x80, 0xff, 0x100, 0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x7f800000};
    return below(3) == 0 ? static_cast<std::uint32_t>(random_()) : kNumbers[below(kNumbers.size())];
  }

  /// Returns a position. Half of the positions are within the first 64 bytes.
  std::size_t place(std::size_t size) { return below(below(2) == 0 ? std::min<std::size_t>(size, 64) : size); }

  void change_bytes(Bytes& bytes) {
    if (bytes.empty()) bytes.push_back(0);
    const std::size_t at = place(bytes.size());
    const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const std::size_t count = 1 + below(std::min<std::size_t>(below(4) == 0 ? 200 : 8, bytes.size() - at));
    switch (below(8)) {
      case 0:
        bytes[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(random_());
        break;
      case 2:
        put_number(bytes, at, telling_number(), std::size_t{1} << below(3));
        break;
      case 3:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] + (below(2) == 0 ? 1 : 255));
        break;
      case 4: {
        Bytes more(count);
        for (std::uint8_t& b : more) b = static_cast<std::uint8_t>(random_());
        bytes.insert(here, more.begin(), more.end());
        break;
      }
      case 5:
        bytes.erase(here, here + static_cast<std::ptrdiff_t>(count));
        break;
      case 6: {
        const Bytes again(here, here + static_cast<std::ptrdiff_t>(count));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() + 1)), again.begin(), again.end());
        break;
      }
      default:
        std::fill_n(here, count, below(2) == 0 ? std::uint8_t{0} : std::uint8_t{255});
        break;
    }
  }

  /// Returns the start of `front`, followed by the end of `end`.
  Bytes spliced(const Bytes& front, const Bytes& end) {
    Bytes out(front.begin(), front.begin() + static_cast<std::ptrdiff_t>(below(front.size() + 1)));
    const std::size_t from = below(2) == 0 ? std::min(out.size(), end.size()) : below(end.size() + 1);
    out.insert(out.end(), end.begin() + static_cast<std::ptrdiff_t>(from), end.end());
    return out;
  }

  void change_chunks(std::vector<Part>& chunks) {
    const std::vector<Part>& others = streams_[below(streams_.size())].chunks;
    if (chunks.empty()) {
      if (!others.empty()) chunks.push_back(others[below(others.size())]);
      return;
    }
    const std::size_t at = below(chunks.size());
    const auto anywhere = [&] { return chunks.begin() + static_cast<std::ptrdiff_t>(below(chunks.size() + 1)); };
    switch (below(9)) {
      case 0: {
        const Part again = chunks[at];
        chunks.insert(anywhere(), again);
        break;
      }
      case 1:
        chunks.erase(chunks.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      case 2:
        std::swap(chunks[at], chunks[below(chunks.size())]);
        break;
      case 3:
        std::shuffle(chunks.begin(), chunks.end(), random_);
        break;
      case 4:
        chunks[at].type = static_cast<std::uint16_t>(below(12));
        break;
      case 5:
        if (!others.empty()) chunks.insert(anywhere(), others[below(others.size())]);
        break;
      case 6:
        if (!others.empty()) chunks[at].bytes = spliced(chunks[at].bytes, others[below(others.size())].bytes);
        break;
      case 7:
        chunks[at].bytes = spliced(chunks[at].bytes, chunks[below(chunks.size())].bytes);
        break;
      default:
        chunks[at].bytes.resize(below(chunks[at].bytes.size() + 1));
        break;
    }
  }

  void change(SeedStream& stream) {
    const std::size_t kind = below(16);
    if (kind == 0) {
      put_number(stream.fixed, 8 + below(kFixedHeader - 8), telling_number(), std::size_t{1} << below(3));
    } else if (kind == 1) {
      const std::vector<Part>& others = streams_[below(streams_.size())].sections;
      if (!others.empty() && below(2) == 0)
        stream.sections.insert(stream.sections.begin() + static_cast<std::ptrdiff_t>(below(stream.sections.size() + 1)),
                               others[below(others.size())]);
      else if (!stream.sections.empty())
        stream.sections.erase(stream.sections.begin() + static_cast<std::ptrdiff_t>(below(stream.sections.size())));
    } else if (kind < 4 && !stream.sections.empty()) {
      change_bytes(stream.sections[below(stream.sections.size())].bytes);
    } else if (kind < 7 || stream.chunks.empty()) {
      change_chunks(stream.chunks);
    } else {
      change_bytes(stream.chunks[below(stream.chunks.size())].bytes);
    }
  }

  static Bytes joined(const SeedStream& stream) {
    Bytes bytes = stream.fixed;
    const auto put = [&](std::uint64_t value, std::size_t size) {
      for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    };
    for (const Part& section : stream.sections) {
      put(section.type, 2);
      put(static_cast<std::uint32_t>(section.bytes.size()), 4);
      bytes.insert(bytes.end(), section.bytes.begin(), section.bytes.end());
    }
    put_number(bytes, kHeaderLength, static_cast<std::uint32_t>(bytes.size()), 4);
    for (const Part& chunk : stream.chunks) {
      put(0x4351, 2);
      put(static_cast<std::uint32_t>(chunk.bytes.size()), 2);
      put(chunk.type, 1);
      put(0, 5);
      bytes.insert(bytes.end(), chunk.bytes.begin(), chunk.bytes.end());
    }
    return bytes;
  }

  /// Changes one length of the container.
  void forge(Bytes& bytes) {
    if (bytes.size() < kFixedHeader + kChunkHead) return;
    std::vector<std::pair<std::size_t, std::size_t>> lengths{{kHeaderLength, 4}};
    const std::size_t header = std::min<std::size_t>(number_at(bytes, kHeaderLength, 4), bytes.size());
    for (std::size_t i = kFixedHeader; i + kSectionHead <= header; i += kSectionHead + number_at(bytes, i + 2, 4))
      lengths.emplace_back(i + 2, 4);
    for (std::size_t i = header; i + kChunkHead <= bytes.size(); i += kChunkHead + number_at(bytes, i + 2, 2))
      lengths.emplace_back(i + 2, 2);
    const auto [at, size] = lengths[below(lengths.size())];
    const std::uint32_t near = number_at(bytes, at, size) + static_cast<std::uint32_t>(below(9)) - 4;
    put_number(bytes, at, below(2) == 0 ? near : telling_number(), size);
  }

  const std::vector<SeedStream>& streams_;
  std::mt19937_64 random_;
};

std::vector<SeedStream> streams_in(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && entry.path().extension() == ".qnv" && entry.file_size() <= kMaxBytes)
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<SeedStream> streams;
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    SeedStream stream = parts_of(Bytes(std::istreambuf_iterator<char>(file), {}), path.filename().string());
    // Several corpora may contain the same file. Files that are not streams are left out.
    const auto same = [&](const SeedStream& other) { return other.name == stream.name; };
    if (!stream.chunks.empty() && std::none_of(streams.begin(), streams.end(), same))
      streams.push_back(std::move(stream));
  }
  return streams;
}

/// Overwrites a file. Ends the program if it cannot.
void keep(int file, const Bytes& bytes) {
  require(pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  require(ftruncate(file, static_cast<off_t>(bytes.size())) == 0);
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Count {
  std::size_t inputs = 0, taken = 0;  // taken: at least the header was valid
  double seconds = 0, longest = 0;
};

int run(std::size_t count, std::uint64_t seed, std::size_t first, const char* kept, const char* numbered,
        const std::vector<fs::path>& folders) {
  const std::vector<SeedStream> streams = streams_in(folders);
  const std::vector<FuzzTarget> targets = fuzz_targets();
  if (streams.empty() || targets.empty()) {
    std::fprintf(stderr, "no streams in these folders\n");
    return 2;
  }
  const int file = open(kept, O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  const int number = open(numbered, O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (file < 0 || number < 0) {
    std::perror(file < 0 ? kept : numbered);
    return 2;
  }
  std::vector<std::size_t> turns;
  for (std::size_t i = 0; i < streams.size(); ++i)
    turns.insert(turns.end(), streams[i].size < kSmallBytes ? kSmallTurns : 1, i);
  std::map<std::string, Count> counts;
  for (std::size_t i = first; i < count; ++i) {
    Mutator mutator(streams, seed * 1'000'000'007 + i);
    const std::size_t turn = turns[i % turns.size()];
    const SeedStream& stream = streams[turn];
    const Bytes bytes = mutator.mutated(turn);
    keep(file, bytes);
    const std::string which = std::to_string(i);
    keep(number, Bytes(which.begin(), which.end()));
    // SIGPROF ends the process after this time.
    const itimerval limit{{0, 0}, {kMaxSeconds, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    const double before = processor_seconds();
    // The first target decodes everything. Only one of the other targets runs; they draw parts.
    const bool taken = targets.front().run(std::as_bytes(std::span(bytes)));
    if (targets.size() > 1) (void)targets[1 + i % (targets.size() - 1)].run(std::as_bytes(std::span(bytes)));
    Count& done = counts[stream.name];
    const double took = processor_seconds() - before;
    ++done.inputs;
    done.taken += taken;
    done.seconds += took;
    done.longest = std::max(done.longest, took);
    if (took > kLongSeconds) std::printf("mutation %zu of %s took %.1f s\n", i, stream.name.c_str(), took);
    if ((i + 1) % 1000 == 0 || i + 1 == count) {
      std::printf("%zu done, %.0f processor seconds\n", i + 1, processor_seconds());
      std::fflush(stdout);
    }
  }
  std::printf("%-28s %8s %8s %9s %9s\n", "stream", "inputs", "read", "ms each", "ms most");
  for (const auto& [name, done] : counts)
    std::printf("%-28s %8zu %8zu %9.1f %9.1f\n", name.c_str(), done.inputs, done.taken,
                1000 * done.seconds / static_cast<double>(done.inputs), 1000 * done.longest);
  return 0;
}

}  // namespace
}  // namespace gs::fuzz

int main(int count, char** arguments) {
  if (count < 7) {
    std::fprintf(stderr, "expected COUNT SEED FIRST KEPT NUMBER FOLDER...\n");
    return 2;
  }
  const auto number = [&](int i) { return std::strtoull(arguments[i], nullptr, 10); };
  return gs::fuzz::run(number(1), number(2), number(3), arguments[4], arguments[5], {arguments + 6, arguments + count});
}
