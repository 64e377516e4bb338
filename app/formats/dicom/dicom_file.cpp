#include "app/formats/dicom/dicom_file.h"

#include "app/formats/common/text_cursor.h"
#include "app/formats/volume/volume_common.h"
#include "base/text.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

// Reader of data sets (PS3.5, 7) and files (PS3.10, 7). It keeps no bytes that DicomTag does not list.

namespace gs::app {
namespace {

constexpr std::size_t kPreamble = 128;
constexpr std::uint32_t kUndefined = 0xffffffff;

bool is_vr(std::byte first, std::byte second) {
  const auto letter = [](std::byte byte) { return byte >= std::byte{'A'} && byte <= std::byte{'Z'}; };
  return letter(first) && letter(second);
}

/// Encoding of elements: with or without their value representations, and the order of bytes.
struct DicomEncoding {
  bool explicit_vr = true;
  bool big_endian = false;
};

std::uint32_t dicom_number(std::span<const std::byte> bytes, std::size_t at, std::size_t size, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i)
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << 8 * (big_endian ? size - 1 - i : i);
  return value;
}

/// Thrown if a file has more elements than any image, or the budget stops the work.
struct TooManyElements {};

/// Parser of the elements between two places of a file.
class DicomParser {
 public:
  DicomParser(std::span<const std::byte> bytes, const WorldBudget& budget, DicomFile& file)
      : bytes_(bytes), budget_(budget), share_(budget, Resource::volumes), file_(file) {}

  /// Parses elements up to `end`, the end mark of an item, or the pixels. `keep` may be null.
  void elements(DicomEncoding encoding, std::size_t end, int depth, DicomDataSet* keep) {
    while (end - at_ >= 8 && !done_) {
      const std::size_t start = at_;
      const auto tag = static_cast<DicomTag>(number(2, encoding.big_endian) << 16 | number(2, encoding.big_endian));
      if (tag == DicomTag::item_end || tag == DicomTag::sequence_end) {
        at_ += 4;
        return;
      }
      if (depth == 0 && !is_meta(tag) && meta_) {
        at_ = start;
        return;
      }
      Length length;
      if (!header(encoding, end, length)) return;
      element(tag, encoding, length, end, depth, keep);
    }
    at_ = std::max(at_, std::min(end, bytes_.size()));
  }

  /// Parses the elements of the group 0002, which are always explicit and little-endian.
  void meta(DicomDataSet& keep) {
    meta_ = true;
    elements({true, false}, bytes_.size(), 0, &keep);
    meta_ = false;
  }
  void start_at(std::size_t place) { at_ = place; }
  [[nodiscard]] std::size_t place() const { return at_; }

 private:
  struct Length {
    std::uint32_t bytes = 0;
    bool is_sequence = false, is_unknown = false;
  };

  static bool is_meta(DicomTag tag) { return static_cast<std::uint32_t>(tag) >> 16 == 2; }

  std::uint32_t number(std::size_t size, bool big_endian) {
    at_ += size;
    return dicom_number(bytes_, at_ - size, size, big_endian);
  }

  // Reads the length of an element, and its VR if there is one. Some explicit files have elements without VR.
  bool header(DicomEncoding encoding, std::size_t end, Length& length) {
    if (!encoding.explicit_vr || !is_vr(bytes_[at_], bytes_[at_ + 1])) {
      length.bytes = number(4, encoding.big_endian);
      return true;
    }
    const std::array<char, 2> name{static_cast<char>(bytes_[at_]), static_cast<char>(bytes_[at_ + 1])};
    const std::string_view vr(name.data(), name.size());
    length.is_sequence = vr == "SQ";
    length.is_unknown = vr == "UN";
    at_ += 2;
    static constexpr std::string_view kLong = "OB OD OF OL OV OW SQ SV UC UN UR UT UV ";
    if (kLong.find(vr) == std::string_view::npos) {
      length.bytes = number(2, encoding.big_endian);
      return true;
    }
    if (end - at_ < 6) return false;
    at_ += 2;
    length.bytes = number(4, encoding.big_endian);
    return true;
  }

  void element(DicomTag tag, DicomEncoding encoding, Length length, std::size_t end, int depth, DicomDataSet* keep) {
    constexpr std::size_t kMostDicomElements = 4'000'000;
    if (++count_ > kMostDicomElements || (count_ % 1024 == 0 && budget_->stopped())) throw TooManyElements();
    const DicomForm form = form_of(tag);
    const bool is_pixels = form == DicomForm::bytes;
    if (length.bytes == kUndefined && tag == DicomTag::pixels) {
      fragments();
      done_ = done_ || depth == 0;
      return;
    }
    // "UN" with an undefined length is a sequence in the implicit encoding (PS3.5, 6.2.2).
    if (length.bytes == kUndefined || length.is_sequence || form == DicomForm::sequence) {
      DicomEncoding inside = encoding;
      if (length.is_unknown) inside = {false, false};
      DicomElement* kept = nullptr;
      if (keep && form == DicomForm::sequence) {
        charge(sizeof(DicomElement));
        keep->elements.push_back({tag, encoding.big_endian, {}, {}});
        kept = &keep->elements.back();
      }
      sequence(inside, length.bytes == kUndefined ? end : at_ + std::min<std::size_t>(length.bytes, end - at_), depth,
               kept);
      return;
    }
    const std::size_t size = std::min<std::size_t>(length.bytes, end - at_);
    if (keep && form != DicomForm::unknown) {
      charge(sizeof(DicomElement));
      keep->elements.push_back({tag, encoding.big_endian, bytes_.subspan(at_, size), {}});
    }
    at_ += size;
    done_ = done_ || (is_pixels && depth == 0);
  }

  void sequence(DicomEncoding encoding, std::size_t end, int depth, DicomElement* kept) {
    constexpr int kMostDicomDepth = 24;
    if (depth >= kMostDicomDepth) throw TooManyElements();
    while (end - at_ >= 8 && !done_) {
      const std::size_t start = at_;
      const auto tag = static_cast<DicomTag>(number(2, encoding.big_endian) << 16 | number(2, encoding.big_endian));
      const std::uint32_t length = number(4, encoding.big_endian);
      if (tag == DicomTag::sequence_end) return;
      if (tag != DicomTag::item) {
        at_ = start;  // the sequence lacks its end mark
        return;
      }
      DicomDataSet* item = nullptr;
      if (kept) {
        charge(sizeof(DicomDataSet));
        item = &kept->items.emplace_back();
      }
      elements(encoding, length == kUndefined ? end : at_ + std::min<std::size_t>(length, end - at_), depth + 1, item);
    }
    at_ = std::max(at_, std::min(end, bytes_.size()));
  }

  // Collects the fragments of encoded pixels: items with lengths (PS3.5, A.4).
  void fragments() {
    constexpr std::size_t kMostFragments = 1'000'000;
    std::vector<std::span<const std::byte>> found;
    while (bytes_.size() - at_ >= 8) {
      const auto tag = static_cast<DicomTag>(number(2, false) << 16 | number(2, false));
      const std::uint32_t length = number(4, false);
      if (tag != DicomTag::item || found.size() >= kMostFragments) break;
      charge(sizeof(found[0]));
      const std::size_t size = std::min<std::size_t>(length, bytes_.size() - at_);
      found.push_back(bytes_.subspan(at_, size));
      at_ += size;
    }
    file_.fragments = std::move(found);
  }

  void charge(std::size_t bytes) {
    if (!share_.grow(bytes)) throw TooManyElements();
  }

  std::span<const std::byte> bytes_;
  WorldBudget budget_;
  Share share_;
  DicomFile& file_;
  std::size_t at_ = 0, count_ = 0;
  bool meta_ = false, done_ = false;
};

/// Row of the transfer syntaxes (PS3.6, table A-1).
struct SyntaxRow {
  std::string_view uid;
  DicomCodec codec;
  DicomEncoding encoding;
  bool deflated = false;
};
constexpr std::string_view kSyntaxRoot = "1.2.840.10008.1.2";
constexpr SyntaxRow kSyntaxes[] = {
    {"", DicomCodec::native, {false, false}},
    {".1", DicomCodec::native, {true, false}},
    {".1.98", DicomCodec::native, {true, false}},  // frames of native pixels in fragments
    {".1.99", DicomCodec::native, {true, false}, true},
    {".2", DicomCodec::native, {true, true}},
    {".5", DicomCodec::rle, {true, false}},
    {".4.50", DicomCodec::jpeg, {true, false}},
    {".4.51", DicomCodec::jpeg, {true, false}},
    {".4.53", DicomCodec::jpeg, {true, false}},
    {".4.55", DicomCodec::jpeg, {true, false}},
    {".4.57", DicomCodec::jpeg_lossless, {true, false}},
    {".4.70", DicomCodec::jpeg_lossless, {true, false}},
    {".4.80", DicomCodec::jpeg_ls, {true, false}},
    {".4.81", DicomCodec::jpeg_ls, {true, false}},
    {".4.90", DicomCodec::jpeg_2000, {true, false}},
    {".4.91", DicomCodec::jpeg_2000, {true, false}},
    {".4.92", DicomCodec::jpeg_2000, {true, false}},
    {".4.93", DicomCodec::jpeg_2000, {true, false}},
};

const SyntaxRow* syntax_of(std::string_view uid) {
  if (!uid.starts_with(kSyntaxRoot)) return nullptr;
  uid.remove_prefix(kSyntaxRoot.size());
  for (const SyntaxRow& row : kSyntaxes)
    if (row.uid == uid) return &row;
  return nullptr;
}

/// Returns the encoding of a data set if its file states none: by the VR and the group of its first element.
DicomEncoding guessed(std::span<const std::byte> bytes) {
  if (bytes.size() < 8) return {};
  return {is_vr(bytes[4], bytes[5]), bytes[0] == std::byte{0} && bytes[1] != std::byte{0}};
}

BytesResult inflated(std::span<const std::byte> bytes, const WorldBudget& budget) {
  constexpr std::size_t kFirst = std::size_t{1} << 16;
  VoxelMemory memory;
  memory.share = Share(budget, Resource::volumes);
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return std::string("zlib cannot be initialised");
  int status = Z_OK;
  std::size_t made = 0, given = 0;
  bool refused = false;
  while (status == Z_OK && !budget->stopped()) {
    if (made == memory.bytes.size()) {
      const std::size_t more = std::max(kFirst, made);
      refused = !memory.share.grow(more);
      if (refused) break;
      memory.bytes.resize(made + more);
    }
    constexpr std::size_t kMost = std::size_t{1} << 30;
    const auto in = static_cast<uInt>(std::min(bytes.size() - given, kMost));
    const auto room = static_cast<uInt>(std::min(memory.bytes.size() - made, kMost));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data() + given));
    stream.avail_in = in;
    stream.next_out = reinterpret_cast<Bytef*>(memory.bytes.data() + made);
    stream.avail_out = room;
    status = inflate(&stream, Z_NO_FLUSH);
    given += in - stream.avail_in;
    made += room - stream.avail_out;
  }
  inflateEnd(&stream);
  if (refused) return "the deflated data are " + budget->refusal(Resource::volumes);
  if (made == 0) return std::string("the deflated data are damaged");
  memory.bytes.resize(made);  // damaged data give the elements before the damage
  return shared_bytes(std::move(memory));
}

double parsed_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = NAN;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() ? value : NAN;
}

}  // namespace

const DicomElement* DicomDataSet::find(DicomTag tag) const {
  for (const DicomElement& element : elements)
    if (element.tag == tag) return &element;
  return nullptr;
}

std::string_view DicomDataSet::text(DicomTag tag) const {
  const DicomElement* element = find(tag);
  if (!element) return {};
  const std::string_view all = text_of(element->value);
  return trimmed(all.substr(0, std::min(all.find('\0'), all.size())));
}

std::vector<double> DicomDataSet::numbers(DicomTag tag, std::size_t most) const {
  std::vector<double> result;
  const DicomElement* element = find(tag);
  if (!element) return result;
  const auto binary = [&](auto kind) {
    using T = decltype(kind);
    for (std::size_t at = 0; at + sizeof(T) <= element->value.size() && result.size() < most; at += sizeof(T)) {
      std::array<std::byte, sizeof(T)> raw{};
      std::memcpy(raw.data(), element->value.data() + at, sizeof(T));
      if (element->big_endian) std::reverse(raw.begin(), raw.end());
      result.push_back(static_cast<double>(std::bit_cast<T>(raw)));
    }
  };
  switch (form_of(tag)) {
    case DicomForm::text: {
      std::string_view rest = text(tag);
      while (!rest.empty() && result.size() < most) {
        const std::size_t end = std::min(rest.find('\\'), rest.size());
        result.push_back(parsed_number(rest.substr(0, end)));
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
      break;
    }
    case DicomForm::u16:
      binary(std::uint16_t{});
      break;
    case DicomForm::u32:
      binary(std::uint32_t{});
      break;
    case DicomForm::u64:
      binary(std::uint64_t{});
      break;
    case DicomForm::f32:
      binary(float{});
      break;
    case DicomForm::f64:
      binary(double{});
      break;
    case DicomForm::sequence:
    case DicomForm::bytes:
    case DicomForm::unknown:
      break;
  }
  return result;
}

std::optional<double> DicomDataSet::number(DicomTag tag) const {
  const std::vector<double> all = numbers(tag, 1);
  return !all.empty() && std::isfinite(all[0]) ? std::optional(all[0]) : std::nullopt;
}

std::uint32_t DicomDataSet::whole(DicomTag tag, std::uint32_t otherwise) const {
  const auto value = number(tag);
  return value && *value >= 0 && *value <= 65535 ? static_cast<std::uint32_t>(*value) : otherwise;
}

std::span<const DicomDataSet> DicomDataSet::items(DicomTag sequence) const {
  const DicomElement* element = find(sequence);
  return element ? std::span<const DicomDataSet>(element->items) : std::span<const DicomDataSet>();
}

const DicomDataSet* DicomDataSet::item(DicomTag sequence) const {
  const std::span<const DicomDataSet> all = items(sequence);
  return all.empty() ? nullptr : &all.front();
}

bool is_dicom(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (text.size() >= kPreamble + 4 && text.substr(kPreamble, 4) == "DICM") return true;
  // Old files begin with an element of the groups 0002 or 0008.
  if (text.size() < 16) return false;
  const bool big_endian = bytes[0] == std::byte{0};
  const std::uint32_t group = dicom_number(bytes, 0, 2, big_endian), element = dicom_number(bytes, 2, 2, big_endian);
  if (is_vr(bytes[4], bytes[5])) {
    const std::string_view vr = text.substr(4, 2);
    const std::uint32_t length = dicom_number(bytes, 6, 2, big_endian);
    if (group == 2 && element == 0) return vr == "UL" && length == 4;
    return group == 8 &&
           (element == 0 ? vr == "UL" && length == 4
                         : (element == 5 || element == 8 || element == 0x16 || element == 0x18 || element == 0x60) &&
                               (vr == "CS" || vr == "UI") && length <= 128);
  }
  const std::uint32_t length = dicom_number(bytes, 4, 4, big_endian);
  if (element == 0) return (group == 2 || group == 8) && length == 4;
  return group == 8 && (element == 5 || element == 8 || element == 0x16 || element == 0x18) && length > 1 &&
         length <= 128 && length % 2 == 0 && bytes[8] >= std::byte{'0'} && bytes[8] <= std::byte{'Z'};
}

std::variant<DicomFile, std::string> read_dicom_file(SharedBytes content, const WorldBudget& budget) {
  const std::string_view text = text_of(content.bytes);
  const bool preamble = text.size() >= kPreamble + 4 && text.substr(kPreamble, 4) == "DICM";
  if (!preamble && !is_dicom(content.bytes)) return std::string("no DICM mark behind 128 bytes; expected a DICOM file");
  DicomFile file;
  file.content = std::move(content);
  try {
    DicomDataSet meta;
    std::size_t begin = preamble ? kPreamble + 4 : 0;
    {
      DicomParser parser(file.content.bytes, budget, file);
      parser.start_at(begin);
      parser.meta(meta);
      begin = parser.place();
    }
    file.syntax = std::string(meta.text(DicomTag::transfer_syntax).substr(0, 64));
    const SyntaxRow* syntax = syntax_of(file.syntax);
    DicomEncoding encoding = guessed(file.content.bytes.subspan(begin));
    if (syntax) {
      file.codec = syntax->codec;
      // Some writers state another encoding than they use; the VR of the first element decides.
      if (!syntax->deflated && encoding.explicit_vr == syntax->encoding.explicit_vr) encoding = syntax->encoding;
    } else if (!file.syntax.empty()) {
      file.codec = DicomCodec::unknown;
    }
    if (syntax && syntax->deflated) {
      BytesResult whole = inflated(file.content.bytes.subspan(begin), budget);
      if (auto* problem = std::get_if<std::string>(&whole)) return std::move(*problem);
      file.content = std::get<SharedBytes>(std::move(whole));
      encoding = syntax->encoding;
      begin = 0;
    }
    file.big_endian = encoding.big_endian;
    DicomParser parser(file.content.bytes, budget, file);
    parser.start_at(begin);
    parser.elements(encoding, file.content.bytes.size(), 0, &file.data);
  } catch (const TooManyElements&) {
    return std::string("more elements than an image has");
  }
  return file;
}

}  // namespace gs::app
