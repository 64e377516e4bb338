#include "app/picture/frame_writer.h"

#include "net/files/file.h"
#include "render/media/movie_writer.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <span>
#include <utility>

namespace gs::app {
namespace {

/// Returns a message if `name` is an existing file that is not a PNG picture or movie. A mistyped name must not
/// overwrite a world.
std::optional<std::string> refuse_frame_file(const std::string& name, bool movie) {
  std::error_code error;
  if (!std::filesystem::exists(name, error)) return std::nullopt;
  const auto opened = net::map_file(name);
  const auto* file = std::get_if<net::MappedFile>(&opened);
  const auto begins = [&](std::size_t at, std::string_view mark) {
    return file->bytes().size() >= at + mark.size() &&
           std::memcmp(file->bytes().data() + at, mark.data(), mark.size()) == 0;
  };
  if (file && file->bytes().empty()) return std::nullopt;
  const bool same = file && (movie ? begins(4, "ftyp") || begins(0, "\x1a\x45\xdf\xa3") : begins(0, "\x89PNG"));
  if (same) return std::nullopt;
  return name + " already exists and is not a " + (movie ? "movie" : "PNG picture") + "; not overwritten";
}

class NumberedPictures final : public FrameWriter {
 public:
  NumberedPictures(NumberedName name, double dots_per_inch) : name_(std::move(name)), dots_(dots_per_inch) {}
  std::optional<std::string> add(const render::Image& image) override {
    const std::string file = name_.at(count_);
    if (auto problem = refuse_frame_file(file, false)) return problem;
    if (const auto problem = net::write_file_atomically(file, render::encode_png(image, dots_)))
      return file + ": " + problem->message;
    ++count_;
    return std::nullopt;
  }
  std::optional<std::string> finish() override { return std::nullopt; }
  [[nodiscard]] std::string what() const override { return std::to_string(count_) + " pictures"; }

 private:
  NumberedName name_;
  double dots_;
  std::size_t count_ = 0;
};

class MovieFileWriter final : public FrameWriter {
 public:
  MovieFileWriter(std::string name, std::string_view kind, std::unique_ptr<render::MovieWriter> movie)
      : name_(std::move(name)), kind_(kind), movie_(std::move(movie)) {}
  std::optional<std::string> add(const render::Image& image) override {
    const auto problem = movie_->add(image);
    return problem ? std::optional(problem->message) : std::nullopt;
  }
  std::optional<std::string> finish() override {
    auto made = movie_->finish();
    if (auto* problem = std::get_if<render::ImageError>(&made)) return std::move(problem->message);
    if (const auto problem = net::write_file_atomically(name_, std::get<std::vector<std::byte>>(made)))
      return name_ + ": " + problem->message;
    return std::nullopt;
  }
  [[nodiscard]] std::string what() const override { return kind_ + " by " + std::string(movie_->encoder()); }

 private:
  std::string name_, kind_;
  std::unique_ptr<render::MovieWriter> movie_;
};

}  // namespace

std::optional<std::string> check_animation_name(const std::string& name) {
  if (render::movie_format_of(name)) return std::nullopt;
  const auto numbered = numbered_name(name);
  std::string end =
      numbered ? numbered->after.substr(numbered->after.size() - std::min<std::size_t>(4, numbered->after.size())) : "";
  std::transform(end.begin(), end.end(), end.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (end == ".png") return std::nullopt;
  std::string kinds;
  for (const render::MovieFormat& format : render::movie_formats()) kinds += " or " + std::string(format.extension);
  return "expected a name with a number pattern such as walk.%04d.png, or one that ends in" + kinds.substr(3);
}

std::variant<std::unique_ptr<FrameWriter>, std::string> FrameWriter::open(const std::string& name,
                                                                          const glm::ivec2& size, double rate,
                                                                          double dots_per_inch) {
  if (auto problem = check_animation_name(name)) return std::move(*problem);
  const render::MovieFormat* const format = render::movie_format_of(name);
  if (!format) return std::make_unique<NumberedPictures>(*numbered_name(name), dots_per_inch);
  if (auto problem = refuse_frame_file(name, true)) return std::move(*problem);
  auto movie = render::MovieWriter::open(*format, size.x, size.y, rate);
  if (auto* problem = std::get_if<render::ImageError>(&movie)) return std::move(problem->message);
  return std::make_unique<MovieFileWriter>(name, format->name,
                                           std::move(std::get<std::unique_ptr<render::MovieWriter>>(movie)));
}

}  // namespace gs::app
