#pragma once

#include "tests/app/volume_files.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Writer of DICOM files for tests.
namespace gs::test {

/// Data set in the explicit or implicit encoding.
class DicomBuilder {
 public:
  enum class Form { explicit_little, implicit_little, explicit_big };
  explicit DicomBuilder(Form form = Form::explicit_little) : form_(form) {}

  DicomBuilder& text(std::uint32_t tag, const char* vr, std::string value) {
    if (value.size() % 2 != 0) value += std::string_view(vr) == "UI" ? '\0' : ' ';
    return bytes(tag, vr, bytes_of(value));
  }
  DicomBuilder& number(std::uint32_t tag, std::uint16_t value, const char* vr = "US") {
    Bytes raw;
    put_word(raw, value);
    return bytes(tag, vr, raw);
  }
  DicomBuilder& real(std::uint32_t tag, double value) {
    Bytes raw;
    put(raw, value);
    return bytes(tag, "FD", raw);
  }
  DicomBuilder& bytes(std::uint32_t tag, const char* vr, const Bytes& value) {
    head(tag, vr, static_cast<std::uint32_t>(value.size()));
    all_ = all_ + value;
    return *this;
  }
  /// Adds a sequence of items; every second one has an undefined length.
  DicomBuilder& sequence(std::uint32_t tag, const std::vector<DicomBuilder>& items) {
    head(tag, "SQ", 0xffffffff);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const bool open = i % 2 == 1;
      mark(0xfffee000, open ? 0xffffffff : static_cast<std::uint32_t>(items[i].all_.size()));
      all_ = all_ + items[i].all_;
      if (open) mark(0xfffee00d, 0);
    }
    mark(0xfffee0dd, 0);
    return *this;
  }
  /// Adds encoded pixels: a table of offsets that is empty, and the fragments.
  DicomBuilder& fragments(const std::vector<Bytes>& parts) {
    head(0x7fe00010, "OB", 0xffffffff);
    mark(0xfffee000, 0);
    for (const Bytes& part : parts) {
      mark(0xfffee000, static_cast<std::uint32_t>(part.size()));
      all_ = all_ + part;
    }
    mark(0xfffee0dd, 0);
    return *this;
  }

  /// Returns the file with the preamble and the transfer syntax.
  [[nodiscard]] std::string file(const std::string& syntax = "1.2.840.10008.1.2.1", bool deflate = false) const {
    DicomBuilder meta;
    meta.text(0x00020010, "UI", syntax);
    return std::string(128, '\0') + "DICM" + string_of(meta.all_ + (deflate ? deflated(all_, -15) : all_));
  }
  [[nodiscard]] const Bytes& data() const { return all_; }

 private:
  void put_word(Bytes& to, std::uint16_t value) const {
    if (form_ == Form::explicit_big)
      put_big(to, value);
    else
      put(to, value);
  }
  void put_long(Bytes& to, std::uint32_t value) const {
    if (form_ == Form::explicit_big)
      put_big(to, value);
    else
      put(to, value);
  }
  void put_tag(std::uint32_t tag) {
    put_word(all_, static_cast<std::uint16_t>(tag >> 16));
    put_word(all_, static_cast<std::uint16_t>(tag));
  }
  void mark(std::uint32_t tag, std::uint32_t length) {
    put_tag(tag);
    put_long(all_, length);
  }
  void head(std::uint32_t tag, std::string_view vr, std::uint32_t length) {
    put_tag(tag);
    if (form_ == Form::implicit_little) return put_long(all_, length);
    all_ = all_ + bytes_of(std::string(vr));
    if (vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN") {
      put_word(all_, 0);
      put_long(all_, length);
    } else {
      put_word(all_, static_cast<std::uint16_t>(length));
    }
  }

  Form form_;
  Bytes all_;
};

/// Slice of a CT series: 4 x 3 pixels of 16 bits. Pixel i of a slice has the value first + i.
struct CtSlice {
  std::string series = "1.2.3", position = "0\\0\\0", orientation = "1\\0\\0\\0\\1\\0", spacing = "0.5\\0.25";
  std::string slope = "1", intercept = "-1024";
  int series_number = 2, instance = 1, temporal = 0, first = 100;
  DicomBuilder::Form form = DicomBuilder::Form::explicit_little;

  [[nodiscard]] DicomBuilder data() const {
    DicomBuilder builder(form);
    builder.text(0x00080060, "CS", "CT").text(0x00100010, "PN", "Secret^Name").text(0x00100020, "LO", "SECRET-ID");
    builder.text(0x00100030, "DA", "19700102").text(0x00180088, "DS", "9").text(0x0020000e, "UI", series);
    builder.text(0x00200011, "IS", std::to_string(series_number)).text(0x00200013, "IS", std::to_string(instance));
    builder.text(0x00200032, "DS", position).text(0x00200037, "DS", orientation);
    if (temporal > 0) builder.text(0x00200100, "IS", std::to_string(temporal));
    builder.number(0x00280002, 1).text(0x00280004, "CS", "MONOCHROME2").number(0x00280010, 3).number(0x00280011, 4);
    builder.text(0x00280030, "DS", spacing).number(0x00280100, 16).number(0x00280101, 12).number(0x00280102, 11);
    builder.number(0x00280103, 0).text(0x00281050, "DS", "40").text(0x00281051, "DS", "400");
    builder.text(0x00281052, "DS", intercept).text(0x00281053, "DS", slope);
    Bytes pixels;
    for (int i = 0; i < 12; ++i) {
      const auto value = static_cast<std::uint16_t>(first + i);
      if (form == DicomBuilder::Form::explicit_big)
        put_big(pixels, value);
      else
        put(pixels, value);
    }
    return builder.bytes(0x7fe00010, "OW", pixels);
  }
  [[nodiscard]] std::string file() const { return data().file(); }
};

/// Returns the values of a metadata key.
inline std::vector<std::string> metadata_values(const qnv::VolumeLayout& layout, std::string_view key) {
  std::vector<std::string> values;
  for (const auto& [name, value] : layout.metadata)
    if (name == key) values.push_back(value);
  return values;
}

inline qnv::VolumeSource opened_as(const std::string& path, const app::VoxelComponent& component) {
  auto result = app::open_volume(path, {}, {nullptr, {}, component});
  if (const auto* problem = std::get_if<std::string>(&result)) FAIL(*problem);
  return std::get<qnv::VolumeSource>(std::move(result));
}

}  // namespace gs::test
