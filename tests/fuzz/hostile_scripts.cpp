// Runs generated worlds with hostile Scripts, each in an own process. See script_worlds.h and usage().
#include "tests/fuzz/scripts/script_worlds.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// Sets default options of AddressSanitizer. ASAN_OPTIONS overrides them.
extern "C" const char* __asan_default_options();  // NOLINT: the sanitizer defines this name
extern "C" const char* __asan_default_options() {
  return "detect_leaks=1:handle_abort=1:handle_sigill=1:hard_rss_limit_mb=2048:malloc_context_size=12:quarantine_size_"
         "mb=32";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() { return "print_stacktrace=1"; }

namespace gs::fuzz {
namespace {

namespace fs = std::filesystem;
constexpr rlim_t kMaxSeconds = 60;  // processor seconds for one world
constexpr unsigned kMaxWait = 600;  // maximum seconds of elapsed time, for a busy machine

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const fs::path& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
}

struct Outcome {
  std::string kind;    // kind of fault; empty if the world passed
  std::string report;  // standard error of the process
};

/// Returns a text with the kind of fault and the innermost functions of the project. Equal faults have equal texts.
std::string kind_of(int status, const std::string& report) {
  std::string kind;
  std::size_t at = std::string::npos;
  for (const char* mark : {"ERROR: AddressSanitizer: ", "ERROR: LeakSanitizer: ", "runtime error: "}) {
    at = report.find(mark);
    if (at == std::string::npos) continue;
    at += std::strlen(mark);
    kind = report.substr(at, report.find_first_of("\n(", at) - at);
    // Remove addresses, which differ from run to run.
    kind = kind.substr(0, std::min(kind.find(" on "), kind.find(" 0x")));
    break;
  }
  if (kind.empty() && status == 0) return {};
  if (kind.empty()) kind = WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status)) : "exit status";
  if (kind.starts_with("stack-overflow") || at == std::string::npos) return kind;
  constexpr std::string_view kFrame = " in gs::";
  constexpr int kFrames = 2;
  const char* between = " in ";
  for (int frames = 0; frames < kFrames; ++frames) {
    at = report.find(kFrame, at);
    if (at == std::string::npos) break;
    at += 4;
    kind += between + report.substr(at, report.find_first_of("(<\n", at) - at);
    between = " < ";
  }
  return kind;
}

Outcome play_in_child(const std::string& text, const fs::path& log) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int file = open(log.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644);
    if (file < 0 || dup2(file, STDERR_FILENO) < 0) _exit(3);
    const rlimit limit{kMaxSeconds, kMaxSeconds + 2};
    (void)setrlimit(RLIMIT_CPU, &limit);
    (void)alarm(kMaxWait);
    (void)play_script_world(text, false);
    std::exit(0);  // LeakSanitizer checks at this point
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) {
    std::perror("hostile_scripts");
    std::exit(2);
  }
  Outcome outcome;
  outcome.report = read_file(log);
  outcome.kind = kind_of(status, outcome.report);
  return outcome;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

/// Returns the index of the line after the block that `first` opens. Returns first + 1 if it opens no block.
std::size_t end_of_block(const std::vector<std::string>& lines, std::size_t first) {
  constexpr std::size_t kMaxLines = 400;
  int open = 0;
  for (std::size_t i = first; i < std::min(lines.size(), first + kMaxLines); ++i) {
    for (const char c : lines[i]) open += (c == '{' || c == '(') ? 1 : (c == '}' || c == ')') ? -1 : 0;
    if (open < 0) break;
    if (open == 0) return i + 1;
  }
  return first + 1;
}

/// Removes parts, blocks and lines, as long as the fault is still the same.
std::string minimised(const std::string& text, const std::string& kind, const fs::path& log) {
  std::vector<std::string> lines = lines_of(text);
  std::size_t runs = 0;
  const auto without = [&](std::size_t first, std::size_t last) {
    std::vector<std::string> fewer(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(first));
    fewer.insert(fewer.end(), lines.begin() + static_cast<std::ptrdiff_t>(last), lines.end());
    ++runs;
    if (play_in_child(joined(fewer), log).kind != kind) return false;
    lines = std::move(fewer);
    return true;
  };
  for (std::size_t before = lines.size() + 1; lines.size() < before;) {
    before = lines.size();
    for (std::size_t size = lines.size() / 2; size >= 1; size /= 2) {
      for (std::size_t end = lines.size(); end > 0; end = end > size ? std::min(end - size, lines.size()) : 0)
        (void)without(end > size ? end - size : 0, end);
      if (size > 8) continue;
      for (std::size_t i = lines.size(); i-- > 0;) {
        if (i >= lines.size()) continue;
        const std::size_t end = end_of_block(lines, i);
        if (end > i + 1 && without(i, end)) continue;
        // Try to remove the lines that open and close a block, but not its content.
        if (end <= i + 1) continue;
        const std::vector<std::string> kept = lines;
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(end) - 1);
        if (!without(i, i + 1)) lines = kept;
      }
    }
  }
  std::printf("%zu lines left after %zu runs\n", lines.size(), runs);
  return joined(lines);
}

int minimise(const fs::path& path) {
  const std::string text = read_file(path);
  const fs::path log = path.string() + ".log";
  const Outcome outcome = play_in_child(text, log);
  if (outcome.kind.empty()) {
    std::printf("%s: passed; nothing to minimise\n", path.c_str());
    return 1;
  }
  const std::string small = minimised(text, outcome.kind, log);
  write_file(path.string() + ".min", small);
  (void)play_in_child(small, log);
  std::printf("%s.min: %s\n", path.c_str(), outcome.kind.c_str());
  return 0;
}

int run_all(std::uint64_t seed, std::uint64_t count, const fs::path& findings) {
  const std::string name = "hostile-" + std::to_string(getpid()) + ".log";
  if (!findings.empty()) fs::create_directories(findings);
  const fs::path log = (findings.empty() ? fs::temp_directory_path() : findings) / name;
  std::uint64_t failures = 0;
  for (std::uint64_t i = seed; i < seed + count; ++i) {
    const std::string text = make_script_world(i);
    const Outcome outcome = play_in_child(text, log);
    constexpr std::uint64_t kNews = 100;
    if (const std::uint64_t done = i - seed + 1; done % kNews == 0) {
      std::printf("%llu worlds done\n", static_cast<unsigned long long>(done));
      std::fflush(stdout);
    }
    if (outcome.kind.empty()) continue;
    ++failures;
    std::printf("seed %llu: %s\n", static_cast<unsigned long long>(i), outcome.kind.c_str());
    std::fflush(stdout);
    if (findings.empty()) {
      std::printf("%s\n", outcome.report.c_str());
      continue;
    }
    const fs::path kept = findings / std::to_string(i);
    write_file(kept.string() + ".world", text);
    write_file(kept.string() + ".log", outcome.kind + "\n" + outcome.report);
  }
  std::error_code ignored;
  fs::remove(log, ignored);
  std::printf("%llu worlds, %llu failures\n", static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(failures));
  return failures == 0 ? 0 : 1;
}

int usage() {
  std::fprintf(stderr,
               "usage: hostile_scripts --seed S --count N [--findings FOLDER]\n"
               "         runs the worlds of the seeds S to S+N-1, and keeps those that fail\n"
               "       hostile_scripts --print S\n"
               "         prints the world of a seed\n"
               "       hostile_scripts --play FILE\n"
               "         runs a world in this process, with the messages of its Scripts\n"
               "       hostile_scripts --minimise FILE\n"
               "         writes the shortest world with the same fault to FILE.min, its report to FILE.log\n");
  return 2;
}

}  // namespace
}  // namespace gs::fuzz

int main(int count, char** arguments) {
  const std::vector<std::string> given(arguments + 1, arguments + count);
  const auto value = [&](const std::string& option) {
    const auto at = std::find(given.begin(), given.end(), option);
    return at == given.end() || at + 1 == given.end() ? std::string() : *(at + 1);
  };
  const auto number = [&](const std::string& option) { return std::strtoull(value(option).c_str(), nullptr, 10); };
  if (!value("--print").empty()) {
    std::printf("%s", gs::fuzz::make_script_world(number("--print")).c_str());
    return 0;
  }
  if (!value("--play").empty()) return gs::fuzz::play_script_world(gs::fuzz::read_file(value("--play")), true) ? 0 : 1;
  if (!value("--minimise").empty()) return gs::fuzz::minimise(value("--minimise"));
  if (value("--seed").empty() || number("--count") == 0) return gs::fuzz::usage();
  return gs::fuzz::run_all(number("--seed"), number("--count"), value("--findings"));
}
