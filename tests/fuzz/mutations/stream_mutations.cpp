// stream_mutations COUNT SEED FIRST KEPT NUMBER FOLDER...: makes the mutations FIRST to COUNT - 1 of the streams
// (*.qnv) in the folders, and passes each to the targets of qnv. A seed and a number always give the same mutation.
// stream_mutator.h describes the mutations.
//
// It writes each input to the file KEPT, and its number to the file NUMBER, before it passes the input on. If a target
// ends the program, these files have the cause. It prints one line per thousand inputs, and a table at the end.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutations/stream_mutator.h"

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

constexpr int kMaxSeconds = 10;     // maximum processor seconds for one input
constexpr double kLongSeconds = 1;  // inputs that take longer are reported
// Smaller streams are mutated kSmallTurns times as often, because larger ones take about five times as long.
constexpr std::size_t kSmallBytes = 7168, kSmallTurns = 6;

std::vector<SeedStream> streams_in(const std::vector<fs::path>& folders) {
  std::vector<fs::path> files;
  for (const fs::path& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && entry.path().extension() == ".qnv" && entry.file_size() <= kMaxMutationBytes)
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
  std::size_t inputs = 0, taken = 0;  // `taken` counts inputs with a valid header
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
    // The first target decodes everything. The other targets draw parts, and only one of them runs.
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
