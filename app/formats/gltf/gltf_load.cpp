#include "app/formats/gltf/gltf_load.h"
#include "app/formats/gltf/glb.h"
#include "base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace gs::app {
namespace {

// Limits for tinygltf. It parses recursively, and needs up to 3 kB for a "{}" and 250 bytes for a ",0".
constexpr std::size_t kMaxDepth = 200;
constexpr std::size_t kObjectBytes = 3000, kValueBytes = 250;
constexpr std::size_t kMaxBuffers = 1000;
constexpr std::size_t kMaxExternalBytes = std::size_t{1} << 32;
constexpr std::size_t kMaxMessage = 500;
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return word;
}

void put_word(std::string& to, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) to += static_cast<char>(word >> (8 * i) & 255);
}

/// Parts of a .gltf or .glb file.
struct Parts {
  bool binary = false;
  std::string_view json;
  std::string_view bin;  // binary chunk of a GLB
};

/// Splits an asset into its parts. A GLB consists of chunks (glTF 2.0 4.4). Returns a message if they are invalid.
std::variant<Parts, std::string> cut(std::span<const std::byte> bytes) {
  if (!text_of(bytes).starts_with("glTF")) return Parts{false, text_of(bytes), {}};
  if (bytes.size() < kGlbHeader + kChunkHeader) return std::string("the file ends within its header");
  if (const std::uint32_t version = word_at(bytes, 4); version != 2)
    return "glTF version " + std::to_string(version) + "; expected 2";
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size())
    return "the file ends too early: expected " + std::to_string(length) + " bytes, found " +
           std::to_string(bytes.size());
  if (length < kGlbHeader + kChunkHeader) return std::string("the length in the header is too small");
  const std::size_t json_length = word_at(bytes, 12);
  if (word_at(bytes, 16) != kJsonChunk || json_length > length - kGlbHeader - kChunkHeader)
    return std::string("broken GLB: expected a JSON chunk within the file");
  Parts parts{true, text_of(bytes.subspan(kGlbHeader + kChunkHeader, json_length)), {}};
  // Chunks are aligned to four bytes.
  const std::size_t next = (kGlbHeader + kChunkHeader + json_length + 3) / 4 * 4;
  if (next >= length) return parts;
  if (length - next < kChunkHeader || word_at(bytes, next) > length - next - kChunkHeader)
    return std::string("broken GLB: the binary chunk exceeds the file");
  if (word_at(bytes, next + 4) == kBinaryChunk)
    parts.bin = text_of(bytes.subspan(next + kChunkHeader, word_at(bytes, next)));
  return parts;
}

/// Checks the size and nesting of a JSON text without parsing it. Returns a message if a limit is exceeded.
std::optional<std::string> too_much(std::string_view json, const Budget& budget) {
  std::size_t depth = 0, objects = 0, values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == ',') ++values;
    if (c == '{') ++objects;
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && depth > 0) --depth;
    if (depth > kMaxDepth) return "nested deeper than " + std::to_string(kMaxDepth) + " levels";
  }
  const std::uint64_t bytes = objects * kObjectBytes + values * kValueBytes;
  if (bytes > budget.left(Resource::files))
    return std::to_string(objects) + " objects and " + std::to_string(values) + " values take " +
           budget.refusal(Resource::files);
  return std::nullopt;
}

/// Checks the buffers. Only the first buffer may omit its uri: tinygltf would copy the binary chunk for each buffer
/// without uri.
std::optional<std::string> check_buffers(const nlohmann::json& document, bool binary) {
  const auto buffers = document.find("buffers");
  if (buffers == document.end() || !buffers->is_array()) return std::nullopt;
  if (buffers->size() > kMaxBuffers) return "more than " + std::to_string(kMaxBuffers) + " buffers";
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const nlohmann::json& buffer = (*buffers)[i];
    const auto uri = buffer.is_object() ? buffer.find("uri") : buffer.end();
    const bool has_uri = buffer.is_object() && uri != buffer.end() && uri->is_string() && !uri->empty() &&
                         !uri->get_ref<const std::string&>().empty();
    if (!has_uri && !(binary && i == 0)) return "buffer " + std::to_string(i) + " has no uri";
  }
  return std::nullopt;
}

/// Returns true if the extensions of a primitive, instead of its accessors, hold its data.
bool has_compressed_data(const nlohmann::json& extensions) {
  if (!extensions.is_object()) return false;
  if (extensions.contains(kDracoExtension) || extensions.contains(kFormerSpzExtension)) return true;
  const auto splats = extensions.find(kSplatExtension);
  if (splats == extensions.end() || !splats->is_object()) return false;
  const auto inner = splats->find("extensions");
  if (inner == splats->end() || !inner->is_object()) return false;
  for (const auto& [name, value] : inner->items())
    if (name.starts_with(kSpzExtension)) return true;
  return false;
}

/// Removes the accessors of compressed primitives. Such accessors have no data, so tinygltf would reject the whole
/// asset. Returns true if there were any.
bool strip_compressed(nlohmann::json& document) {
  bool changed = false;
  const auto meshes = document.find("meshes");
  if (meshes == document.end() || !meshes->is_array()) return false;
  for (nlohmann::json& mesh : *meshes) {
    const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
    if (!mesh.is_object() || primitives == mesh.end() || !primitives->is_array()) continue;
    for (nlohmann::json& primitive : *primitives) {
      if (!primitive.is_object() || !primitive.contains("extensions")) continue;
      if (!has_compressed_data(primitive["extensions"])) continue;
      primitive.erase("indices");
      primitive["attributes"] = nlohmann::json::object();
      changed = true;
    }
  }
  return changed;
}

/// File access for tinygltf. tinygltf first asks whether a file exists and then reads it.
struct Files {
  const ReadFile* read = nullptr;
  std::unordered_map<std::string, SharedBytes> found;
  std::unordered_set<std::string> missing;
  std::size_t total = 0;
  std::string problem;  // error message of the first missing file

  bool exists(const std::string& name) {
    // The importer needs no textures. The renderer loads them later.
    constexpr std::array<std::string_view, 8> kImages = {".png",  ".jpg",  ".jpeg", ".gif",
                                                         ".webp", ".ktx2", ".dds",  ".bmp"};
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    if (std::any_of(kImages.begin(), kImages.end(), [&](std::string_view end) { return lower.ends_with(end); }))
      return false;
    // tinygltf retries a missing file in the current folder, which would be the same file.
    if (name.starts_with("./") && missing.contains(name.substr(2))) return false;
    if (found.contains(name)) return true;
    BytesResult read_now = *read ? (*read)(name) : BytesResult(std::string());
    auto* const bytes = std::get_if<SharedBytes>(&read_now);
    if (!bytes || bytes->bytes.size() > kMaxExternalBytes - total) {
      missing.insert(name);
      if (!bytes && problem.empty()) problem = std::get<std::string>(read_now);
      return false;
    }
    total += bytes->bytes.size();
    found.emplace(name, std::move(*bytes));
    return true;
  }
};

bool file_exists(const std::string& name, void* files) {
  return !name.empty() && static_cast<Files*>(files)->exists(name);
}

std::string same_path(const std::string& name, void*) { return name; }

bool read_whole_file(std::vector<unsigned char>* out, std::string* error, const std::string& name, void* user) {
  auto& found = static_cast<Files*>(user)->found;
  const auto file = found.find(name);
  if (file == found.end()) {
    if (error) *error += "not available";
    return false;
  }
  const auto* first = reinterpret_cast<const unsigned char*>(file->second.bytes.data());
  out->assign(first, first + file->second.bytes.size());
  found.erase(file);
  return true;
}

bool refuse_to_write(std::string* error, const std::string&, const std::vector<unsigned char>&, void*) {
  if (error) *error += "not allowed";
  return false;
}

/// Image callback of tinygltf that keeps the encoded bytes of data: URLs. Ignores images in buffers, because tinygltf
/// does not check their range.
bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
  if (image->bufferView < 0 && image->uri.empty() && bytes && size > 0) image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

/// Runs tinygltf. Returns its error message on failure.
std::optional<std::string> parse(std::string_view asset, bool binary, const ReadFile& read_file,
                                 tinygltf::Model& model) {
  Files files;
  files.read = &read_file;
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  loader.SetFsCallbacks({file_exists, same_path, read_whole_file, refuse_to_write, &files});
  std::string error, warning;
  bool good = false;
  try {
    const auto length = static_cast<unsigned int>(asset.size());
    if (binary)
      good = loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(asset.data()),
                                         length, "");
    else
      good = loader.LoadASCIIFromString(&model, &error, &warning, asset.data(), length, "");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {
    error += exception.what();
  }
  if (good) return std::nullopt;
  error = error.empty() ? "broken glTF" : error.substr(0, kMaxMessage);
  while (!error.empty() && error.back() == '\n') error.pop_back();
  if (!files.problem.empty()) error += " (" + files.problem.substr(0, kMaxMessage) + ")";
  std::replace(error.begin(), error.end(), '\n', ' ');
  return error;
}

std::string glb_of(const std::string& json, std::string_view bin) {
  std::string padded = json, padded_bin(bin);
  padded.resize((padded.size() + 3) / 4 * 4, ' ');
  padded_bin.resize((padded_bin.size() + 3) / 4 * 4, '\0');
  std::string glb = "glTF";
  put_word(glb, 2);
  const std::size_t bin_part = bin.empty() ? 0 : kChunkHeader + padded_bin.size();
  put_word(glb, static_cast<std::uint32_t>(kGlbHeader + kChunkHeader + padded.size() + bin_part));
  put_word(glb, static_cast<std::uint32_t>(padded.size()));
  put_word(glb, kJsonChunk);
  glb += padded;
  if (bin.empty()) return glb;
  put_word(glb, static_cast<std::uint32_t>(padded_bin.size()));
  put_word(glb, kBinaryChunk);
  return glb + padded_bin;
}

}  // namespace

std::optional<tinygltf::Model> load_gltf(std::span<const std::byte> bytes, const ReadFile& read_file,
                                         SceneBuilder& builder) {
  const auto refuse = [&](std::string message) {
    builder.fail("glTF: " + std::move(message));
    return std::nullopt;
  };
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max() / 2) return refuse("over 2 GiB");
  const auto cut_result = cut(bytes);
  if (const auto* why = std::get_if<std::string>(&cut_result)) return refuse(*why);
  const Parts& parts = std::get<Parts>(cut_result);
  if (const auto what = too_much(parts.json, *builder.budget())) return refuse(*what);
  nlohmann::json document = nlohmann::json::parse(parts.json.begin(), parts.json.end(), nullptr, false);
  if (document.is_discarded() || !document.is_object())
    return refuse("expected a JSON object, as glTF 2.0 describes it");
  if (const auto what = check_buffers(document, parts.binary)) return refuse(*what);

  std::string changed;
  if (strip_compressed(document)) changed = document.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  // tinygltf reads beyond chunks with a size that is not a multiple of four bytes. Pad such chunks.
  if (parts.binary && (!changed.empty() || parts.json.size() % 4 != 0 || parts.bin.size() % 4 != 0))
    changed = glb_of(changed.empty() ? std::string(parts.json) : changed, parts.bin);
  document = nullptr;
  std::optional<tinygltf::Model> model(std::in_place);
  if (const auto why = parse(changed.empty() ? text_of(bytes) : changed, parts.binary, read_file, *model))
    return refuse(*why);
  return model;
}

}  // namespace gs::app
