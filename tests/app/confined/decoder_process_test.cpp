#include "app/confined/decoder_process.h"

#include "app/base/confinement.h"
#include "app/confined/decoder_pool.h"
#include "app/confined/image_decoding.h"
#include "tests/app/program.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace gs::app {
namespace decoder_process_test {

using namespace std::chrono_literals;
using Decoded = std::variant<render::Image, render::ImageError>;

render::Image gradient(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  render::Image image;
  image.width = width;
  image.height = height;
  image.components = components;
  for (std::uint32_t i = 0; i < width * height * components; ++i)
    image.pixels.push_back(static_cast<std::uint8_t>(i * 7 + i / width));
  return image;
}

void check_equal(const Decoded& found, const Decoded& expected) {
  REQUIRE(found.index() == expected.index());
  if (const auto* error = std::get_if<render::ImageError>(&found)) {
    CHECK(error->message == std::get<render::ImageError>(expected).message);
    return;
  }
  const auto& image = std::get<render::Image>(found);
  const auto& other = std::get<render::Image>(expected);
  CHECK(image.width == other.width);
  CHECK(image.height == other.height);
  CHECK(image.components == other.components);
  CHECK(image.reduction == other.reduction);
  CHECK(image.slices == other.slices);
  CHECK(image.cube == other.cube);
  CHECK(image.pixels == other.pixels);
}

std::string message_of(const Decoded& decoded) {
  const auto* error = std::get_if<render::ImageError>(&decoded);
  return error ? error->message : "";
}

// Returns the processes that this thread started.
std::vector<pid_t> children() {
  std::ifstream list("/proc/self/task/" + std::to_string(::gettid()) + "/children");
  std::vector<pid_t> all;
  for (pid_t child = 0; list >> child;) all.push_back(child);
  return all;
}

// Reports whether a function succeeds in a process that is confined, by default to decoding.
bool succeeds_in_decoder(const std::function<bool()>& attempt,
                         std::optional<std::string> (*confine)() = confine_decoder) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    if (confine()) ::_exit(3);
    ::_exit(attempt() ? 0 : 1);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  INFO("status " << status);
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) != 3);
  return WEXITSTATUS(status) == 0;
}

DecodeAnswer answer_of(std::uint32_t width, std::uint32_t height, std::uint32_t components) {
  DecodeAnswer answer;
  answer.width = width;
  answer.height = height;
  answer.components = components;
  answer.reduction = answer.slices = 1;
  return answer;
}

}  // namespace decoder_process_test

using namespace decoder_process_test;

TEST_CASE("a confined process decodes images as this process does") {
  DecoderProcess process(program(), DecoderKind::pictures);
  REQUIRE(process.good());
  const pid_t first = process.process();
  for (const std::uint32_t components : {1u, 2u, 3u, 4u})
    for (const std::uint32_t width : {1u, 3u, 64u, 700u}) {
      const auto png = render::encode_png(gradient(width, 90, components));
      check_equal(process.decode(png, {}, 20s), render::decode_image(png));
      render::ImageLimits small;
      small.kept_pixels = 2000;
      check_equal(process.decode(png, small, 20s), render::decode_image(png, small));
      small.file_pixels = 50;
      check_equal(process.decode(png, small, 20s), render::decode_image(png, small));
    }
  const auto jpeg = render::encode_jpeg(gradient(200, 100, 3));
  check_equal(process.decode(jpeg, {}, 20s), render::decode_image(jpeg));
  for (std::size_t bytes = 1; bytes < jpeg.size(); bytes += 97)
    check_equal(process.decode(std::span(jpeg).first(bytes), {}, 20s),
                render::decode_image(std::span(jpeg).first(bytes)));
  CHECK(process.process() == first);
}

TEST_CASE("a decoder process that crashes costs one image") {
  DecoderProcess process(program(), DecoderKind::pictures);
  REQUIRE(process.good());
  const auto png = render::encode_png(gradient(40, 30, 3));
  REQUIRE(::kill(process.process(), SIGSEGV) == 0);
  CHECK(message_of(process.decode(png, {}, 20s)).starts_with("the process that decoded it ended"));
  CHECK_FALSE(process.good());
  CHECK_FALSE(message_of(process.decode(png, {}, 20s)).empty());
}

TEST_CASE("the pool replaces a decoder process that ended while it waited") {
  set_decoder_program(program());
  const auto png = render::encode_png(gradient(40, 30, 3));
  const std::vector<pid_t> before = children();
  check_equal(decode_confined(png, {}), render::decode_image(png));
  std::vector<pid_t> waiting = children();
  std::erase_if(waiting, [&](pid_t child) { return std::ranges::count(before, child) > 0; });
  REQUIRE(waiting.size() == 1);
  check_equal(decode_confined(png, {}), render::decode_image(png));
  CHECK(std::ranges::count(children(), waiting[0]) == 1);  // it was reused
  REQUIRE(::kill(waiting[0], SIGKILL) == 0);
  siginfo_t ended{};
  REQUIRE(::waitid(P_PID, static_cast<id_t>(waiting[0]), &ended, WEXITED | WNOWAIT) == 0);
  check_equal(decode_confined(png, {}), render::decode_image(png));
  CHECK(std::ranges::count(children(), waiting[0]) == 0);
  set_decoder_program({});
}

TEST_CASE("threads decode images in processes of their own") {
  set_decoder_program(program());
  const auto png = render::encode_png(gradient(40, 30, 3));
  std::vector<std::thread> threads;
  std::vector<Decoded> found(6);
  for (std::size_t i = 0; i < found.size(); ++i) threads.emplace_back([&, i] { found[i] = decode_confined(png, {}); });
  for (std::thread& thread : threads) thread.join();
  for (const Decoded& each : found) check_equal(each, render::decode_image(png));
  set_decoder_program({});
  check_equal(decode_confined(png, {}), render::decode_image(png));
}

TEST_CASE("a decoder process that hangs is ended") {
  const auto png = render::encode_png(gradient(40, 30, 3));
  {
    DecoderProcess process(program(), DecoderKind::pictures);
    REQUIRE(process.good());
    const pid_t child = process.process();
    check_equal(process.decode(png, {}, 20s), render::decode_image(png));  // it runs
    REQUIRE(::kill(child, SIGSTOP) == 0);
    CHECK(message_of(process.decode(png, {}, 200ms)) == "decoding takes too long");
    CHECK_FALSE(process.good());
    CHECK(::kill(child, 0) != 0);  // it is reaped
  }
  DecoderProcess process(program(), DecoderKind::pictures);
  REQUIRE(process.good());
  REQUIRE(::kill(process.process(), SIGSTOP) == 0);
  render::ImageLimits limits;
  limits.stopped = [] { return true; };
  CHECK(message_of(process.decode(png, limits, 20s)) == "decoding was stopped");
}

TEST_CASE("decoder processes end with their owner") {
  pid_t child = 0;
  {
    DecoderProcess process(program(), DecoderKind::pictures);
    child = process.process();
    REQUIRE(::kill(child, 0) == 0);
  }
  CHECK(::kill(child, 0) != 0);
  CHECK(errno == ESRCH);
}

TEST_CASE("a missing decoder program gives an error") {
  DecoderProcess process("/nonexistent/program", DecoderKind::pictures);
  CHECK_FALSE(process.good());
  const auto png = render::encode_png(gradient(4, 3, 3));
  CHECK(message_of(process.decode(png, {}, 1s)) == "the process for decoding cannot be started");
}

TEST_CASE("answers of decoder processes are not trusted") {
  const DecodeRequest request{DecodeOperation::picture, 100, 1 << 20, 1000, 1 << 20};
  CHECK(std::holds_alternative<render::Image>(check_answer(answer_of(20, 50, 4), request)));
  const std::string impossible = "the decoder gave an impossible image";
  CHECK(message_of(check_answer(answer_of(20, 51, 4), request)) == impossible);
  CHECK(message_of(check_answer(answer_of(20, 0, 4), request)) == impossible);
  CHECK(message_of(check_answer(answer_of(20, 50, 0), request)) == impossible);
  CHECK(message_of(check_answer(answer_of(20, 50, 5), request)) == impossible);
  CHECK(message_of(check_answer(answer_of(0x80000000u, 2, 1), request)) == impossible);
  CHECK(message_of(check_answer(answer_of(0xffffffffu, 0xffffffffu, 4), request)) == impossible);
  DecodeAnswer slices = answer_of(10, 20, 1);
  slices.slices = 3;
  CHECK(message_of(check_answer(slices, request)) == impossible);
  slices.slices = 0;
  CHECK(message_of(check_answer(slices, request)) == impossible);
  slices.slices = 4;
  slices.cube = 1;
  CHECK(message_of(check_answer(slices, request)) == impossible);
  DecodeAnswer error;
  CHECK(message_of(check_answer(error, request)) == "the decoder gave no result and no reason");
  std::memset(error.text, '\x1b', sizeof error.text);  // also without an end
  CHECK(message_of(check_answer(error, request)) == std::string(DecodeAnswer::kTextBytes, '?'));
}

TEST_CASE("memory for results cannot shrink") {
  auto memory = SharedMemory::create();
  REQUIRE(memory);
  REQUIRE(memory->grow(10'000));
  CHECK(::ftruncate(memory->file(), 5'000) != 0);
  const auto bytes = memory->map(10'000);
  REQUIRE(bytes.size() == 10'000);
  bytes[9'999] = std::byte{7};
  REQUIRE(memory->grow(1'000'000));
  CHECK(memory->map(1'000'000)[9'999] == std::byte{7});
}

TEST_CASE("threads of a confined process set their names, and change nothing else of it") {
  if (!confinement_support().seccomp) {
    WARN("this kernel lacks seccomp");
    return;
  }
  // SpiderMonkey asserts that each of its threads can set its name. Threads may start after the confinement.
  const auto names = [] { return ::pthread_setname_np(::pthread_self(), "late") == 0; };
  const auto late = [&names] {
    bool named = false;
    std::thread([&] { named = names(); }).join();
    return named;
  };
  for (const auto confine : {confine_decoder, confine_programs}) {
    CHECK(succeeds_in_decoder(late, confine));
    CHECK_FALSE(succeeds_in_decoder([] { return ::prctl(PR_SET_DUMPABLE, 1) == 0; }, confine));
    CHECK_FALSE(succeeds_in_decoder([] { return ::prctl(PR_SET_PDEATHSIG, 0) == 0; }, confine));
  }
}

TEST_CASE("a decoder has no files, sockets, programs, processes or executable memory") {
  const ConfinementSupport support = confinement_support();
  if (support.landlock == 0 || !support.seccomp) {
    WARN("this kernel lacks Landlock or seccomp");
    return;
  }
  // Sanitizers may need more calls than decoders.
  CHECK(succeeds_in_decoder([] { return ::getpid() > 0; }));
  CHECK(succeeds_in_decoder(
      [] { return ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED; }));
  CHECK(succeeds_in_decoder([] {
    std::thread([] {}).join();
    return true;
  }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::open("/etc/hostname", O_RDONLY) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::open("/usr/bin/true", O_RDONLY) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::open("/tmp/decoder", O_WRONLY | O_CREAT, 0600) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] {
    struct stat about {};
    return ::stat("/etc/passwd", &about) == 0;
  }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::socket(AF_INET, SOCK_STREAM, 0) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::socket(AF_UNIX, SOCK_STREAM, 0) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::fork() >= 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::kill(::getppid(), 0) == 0; }));
  CHECK_FALSE(succeeds_in_decoder([] { return ::memfd_create("x", 0) >= 0; }));
  CHECK_FALSE(succeeds_in_decoder(
      [] { return ::mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED; }));
  CHECK_FALSE(succeeds_in_decoder([] {
    char* const arguments[] = {const_cast<char*>("true"), nullptr};
    (void)::execv("/usr/bin/true", arguments);
    return false;
  }));
}

}  // namespace gs::app
