// Fuzzes each image format, with one target per row of the table of images. Other targets play sounds and movies.
#include "render/image/image_codecs.h"
#include "render/media/midi_reader.h"
#include "render/media/movie.h"
#include "render/media/sample_reader.h"
#include "tests/fuzz/fuzz_target.h"

#include <zlib.h>

using namespace gs::render;

namespace gs::fuzz {
namespace {

/// Corrects the checksums of a PNG's chunks after a mutation (PNG, clause 5.3). Returns other bytes unchanged.
std::vector<std::byte> mended(std::span<const std::byte> bytes) {
  std::vector<std::byte> png(bytes.begin(), bytes.end());
  constexpr std::size_t kMark = 8, kAround = 12;
  if (!text_of(bytes).starts_with("\x89PNG")) return png;
  for (std::size_t at = kMark; at + kAround <= png.size();) {
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size = size << 8 | std::to_integer<std::size_t>(png[at + i]);
    if (size > png.size() - at - kAround) break;
    const auto* checked = reinterpret_cast<const Bytef*>(png.data() + at + 4);
    const auto sum = static_cast<std::uint32_t>(crc32_z(0, checked, size + 4));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + size + i] = static_cast<std::byte>(sum >> (24 - 8 * i));
    at += size + kAround;
  }
  return png;
}

bool run_image(const ImageFormat& format, std::span<const std::byte> input) {
  const std::vector<std::byte> bytes = mended(input);
  constexpr std::size_t kMaxPixels = std::size_t{1} << 22;
  const DecodedImage decoded = format.decode(bytes, {.file_pixels = kMaxPixels});
  const auto* image = std::get_if<Image>(&decoded);
  if (!image) {
    require(!std::get<ImageError>(decoded).message.empty());
    return false;
  }
  require(image->components >= 1 && image->components <= 4);
  require(std::uint64_t{image->width} * image->height <= kMaxPixels);
  require(image->pixels.size() == std::size_t{image->width} * image->height * image->components);
  if (text_of(bytes).starts_with(format.magic)) require(decode_image(bytes, {.file_pixels = kMaxPixels}).index() == 0);
  return text_of(bytes).starts_with(format.magic);
}

/// Plays up to a minute of a sound, and seeks in it.
bool run_sound(std::span<const std::byte> bytes) {
  if (is_midi(bytes)) {
    const auto song = read_midi(bytes);
    if (const auto* wrong = std::get_if<MediaError>(&song)) require(!wrong->message.empty());
    if (song.index() != 0) return false;
    double before = 0;
    for (const MidiEvent& event : std::get<0>(song).events) {
      require(event.time >= before && event.status >= 0x80 && event.first < 0x80 && event.second < 0x80);
      before = event.time;
    }
    require(std::get<0>(song).duration >= before);
    return true;
  }
  const auto info = examine_media(bytes);
  auto opened = open_samples(bytes);
  if (auto* wrong = std::get_if<MediaError>(&opened)) {
    require(!wrong->message.empty());
    return false;
  }
  SampleReader& reader = *std::get<0>(opened);
  require(reader.rate() > 0 && (reader.channels() == 1 || reader.channels() == 2));
  std::vector<float> samples(2 * 4096);
  const auto hear = [&](int pieces) {
    for (int i = 0; i < pieces; ++i) {
      const std::size_t count = reader.read(samples);
      require(count <= 4096);
      for (std::size_t k = 0; k < 2 * count; ++k) require(samples[k] >= -4 && samples[k] <= 4);
      if (count < 4096) return;
    }
  };
  hear(700);
  for (const double at : {0.4, 1e9, 0.0}) {
    reader.seek(at);
    hear(3);
  }
  return info.index() == 0;
}

/// Plays a movie forwards, backwards, and with jumps.
bool run_movie(std::span<const std::byte> bytes) {
  constexpr std::size_t kMaxPixels = std::size_t{1} << 18;
  auto opened = Movie::open(bytes, {.file_pixels = kMaxPixels});
  if (auto* wrong = std::get_if<ImageError>(&opened)) {
    require(!wrong->message.empty());
    return false;
  }
  bool any = false;
  for (const double at : {0.0, 0.1, 0.3, 1.0, 0.9, 0.5, 0.0, 50.0, 1.0}) {
    const auto found = std::get<0>(opened)->at(at);
    if (found.index() != 0) return false;
    const Movie::Frame* frame = std::get<0>(found);
    if (!frame) return false;
    const Image& image = frame->image;
    require(image.pixels.size() == std::size_t{image.width} * image.height * image.components && !image.empty());
    any = true;
  }
  return any;
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  std::vector<FuzzTarget> targets = {{"sound", run_sound, 1 << 15}, {"movie", run_movie, 1 << 15}};
  for (const ImageFormat& format : image_formats())
    targets.push_back(
        {target_name(format.name), [&format](std::span<const std::byte> bytes) { return run_image(format, bytes); }});
  return targets;
}

}  // namespace gs::fuzz
