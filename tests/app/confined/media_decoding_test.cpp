#include "app/confined/media_decoding.h"

#include "app/confined/decoder_pool.h"
#include "net/files/file.h"
#include "tests/app/program.h"
#include "tests/app/scratch_folder.h"
#include "tests/render/media/media_files.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <unistd.h>

namespace gs::app {
namespace media_decoding_test {

/// Sets the program of decoder children for the life of a test.
struct WithChildren {
  WithChildren() { set_decoder_program(program()); }
  ~WithChildren() { set_decoder_program({}); }
};

std::vector<std::byte> corpus(const std::string& name) {
  return media::bytes_of(media::file_text(std::string(GHOSTSPACE_TESTS) + "/fuzz/corpus/render/" + name));
}

std::vector<std::byte> tones(int rate, int channels, std::size_t count) {
  return media::bytes_of(media::wav(rate, channels, count, [](std::size_t i, int channel) {
    return 0.8 * std::sin(0.01 * static_cast<double>(i) * (channel + 1));
  }));
}

std::set<pid_t> children_now() {
  std::set<pid_t> all;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream list(task.path() / "children");
    for (pid_t child = 0; list >> child;) all.insert(child);
  }
  return all;
}

/// Kills the children of this process, which are all decoders.
void kill_children() {
  std::size_t killed = 0;
  for (const pid_t child : children_now())
    if (::kill(child, SIGKILL) == 0) ++killed;
  REQUIRE(killed > 0);
}

std::unique_ptr<MovieSource> movie_of(const EncodedMedia& media) {
  auto opened = open_movie_confined(media, {});
  INFO((opened.index() == 1 ? std::get<1>(opened).message : ""));
  REQUIRE(opened.index() == 0);
  return std::move(std::get<0>(opened));
}

std::unique_ptr<render::SampleReader> sound_of(const EncodedMedia& media) {
  auto opened = open_samples_confined(media, 48000);
  INFO((opened.index() == 1 ? std::get<1>(opened).message : ""));
  REQUIRE(opened.index() == 0);
  return std::move(std::get<0>(opened));
}

const render::Movie::Frame& frame_at(MovieSource& movie, double seconds) {
  const auto found = movie.at(seconds);
  INFO((found.index() == 1 ? std::get<1>(found).message : ""));
  REQUIRE(found.index() == 0);
  REQUIRE(std::get<0>(found));
  return *std::get<0>(found);
}

TEST_CASE("a child decodes the pictures of a movie as this process does") {
  for (const char* const name : {"movie/counting.mp4", "movie/counting.m1v", "movie/counting.gif"}) {
    INFO(name);
    const auto bytes = corpus(name);
    const auto info = examine_confined({bytes});
    const auto here = movie_of({bytes});
    const WithChildren children;
    const auto same = examine_confined({bytes});
    REQUIRE(info.index() == 0);
    REQUIRE(same.index() == 0);
    CHECK(std::get<0>(same).duration == std::get<0>(info).duration);
    CHECK(std::get<0>(same).pictures == std::get<0>(info).pictures);
    CHECK(std::get<0>(same).sound == std::get<0>(info).sound);
    const auto there = movie_of({bytes});
    for (const double seconds : {0.0, 0.5, 0.52, 0.5, 0.9, 0.1, 0.8, 5.0}) {
      const render::Movie::Frame& expected = frame_at(*here, seconds);
      const render::Movie::Frame& found = frame_at(*there, seconds);
      CHECK(found.time == expected.time);
      CHECK(found.image.pixels == expected.image.pixels);
      CHECK(found.image.width == expected.image.width);
      CHECK(found.image.components == expected.image.components);
    }
  }
}

TEST_CASE("a child reads a mapped movie file without a copy") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.mp4", media::file_text(std::string(GHOSTSPACE_TESTS) +
                                                                  "/fuzz/corpus/render/movie/counting.mp4") +
                                                     std::string(net::MappedFile::kMappedSize, '\0'));
  const auto mapped = net::map_file(path);
  REQUIRE(mapped.index() == 0);
  const auto& file = std::get<0>(mapped);
  REQUIRE(file.descriptor() >= 0);
  const auto here = movie_of({file.bytes(), -1});
  const WithChildren children;
  const auto there = movie_of({file.bytes(), file.descriptor()});
  CHECK(frame_at(*there, 0.5).image.pixels == frame_at(*here, 0.5).image.pixels);
}

TEST_CASE("a child decodes sounds as this process does, also after seeking") {
  const auto bytes = tones(44'100, 2, 100'000);
  const auto here = sound_of({bytes});
  const WithChildren children;
  const auto there = sound_of({bytes});
  CHECK(there->rate() == here->rate());
  CHECK(there->channels() == here->channels());
  for (const double seconds : {-1.0, 1.5, 0.25}) {
    if (seconds >= 0) {
      here->seek(seconds);
      there->seek(seconds);
    }
    std::vector<float> expected(2 * 90'000), found(2 * 90'000);  // more than one request reads
    const std::size_t count = here->read(expected);
    REQUIRE(there->read(found) == count);
    CHECK(found == expected);
  }
  std::vector<float> rest(2 * 200'000);
  (void)there->read(rest);
  CHECK(there->read(rest) == 0);
}

TEST_CASE("a child that ends costs one movie or sound") {
  const auto movie_bytes = corpus("movie/counting.mp4");
  const auto sound_bytes = tones(8000, 1, 8000);
  const WithChildren children;
  const auto movie = movie_of({movie_bytes});
  (void)frame_at(*movie, 0.2);
  const auto sound = sound_of({sound_bytes});
  kill_children();
  const auto failed = movie->at(0.4);
  REQUIRE(failed.index() == 1);
  CHECK(std::get<1>(failed).message.starts_with("the process that decoded it ended"));
  std::vector<float> samples(200);
  CHECK(sound->read(samples) == 0);
  CHECK(sound->read(samples) == 0);
  CHECK(frame_at(*movie_of({movie_bytes}), 0.4).time > 0);
  CHECK(sound_of({sound_bytes})->read(samples) == 100);
}

TEST_CASE("errors of children are those of this process") {
  const auto text = media::bytes_of("no movie at all, only text");
  const auto error = examine_confined({text});
  const auto movie_error = open_movie_confined({text}, {});
  const auto sound_error = open_samples_confined({text}, 48000);
  const WithChildren children;
  CHECK(std::get<1>(examine_confined({text})).message == std::get<1>(error).message);
  CHECK(std::get<1>(open_movie_confined({text}, {})).message == std::get<1>(movie_error).message);
  CHECK(std::get<1>(open_samples_confined({text}, 48000)).message == std::get<1>(sound_error).message);
}

}  // namespace media_decoding_test
}  // namespace gs::app
