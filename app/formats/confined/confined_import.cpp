#include "app/formats/confined/confined_import.h"

#include "app/confined/decoder_pool.h"
#include "app/formats/confined/asset_transfer.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/dataset_formats.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::chrono::minutes kImportPatience{10};  // the limits of a world stop it earlier
constexpr std::size_t kMostReferences = 10'000;      // files that one file may ask for

bool is_confined(const ContentType& type, const ImportSource& source) {
  const bool plain = (type.content == ContentClass::mesh && !type.has_nodes) || type.content == ContentClass::splats;
  // Datasets need a module that a confined child cannot load.
  return plain && type.read != read_dataset_mesh && !DecoderPool::of_program().program().empty() &&
         !(source.local && source.bytes.size() > kMostLocalBytes);
}

ImportRequest import_request(const ContentType& type, const ImportSource& source) {
  ImportRequest request;
  request.type = type.name;
  request.path = source.path;
  request.name = source.name;
  request.reads_files = source.read_file != nullptr;
  request.for_x3d = source.for_x3d;
  request.component = source.component;
  for (std::size_t i = 0; i < kResources.size(); ++i) request.left[i] = source.budget->left(kResources[i].resource);
  return request;
}

/// Returns limits under which a budget has at most `left` of each resource.
Limits limits_of(const std::array<std::uint64_t, kResources.size()>& left) {
  Limits limits;
  std::uint64_t memory = 0;
  for (std::size_t i = 0; i < kResources.size(); ++i)
    if (kResources[i].held) memory = std::max(memory, left[i] * kResources[i].cost * 32 / kResources[i].share);
  limits.memory = static_cast<std::size_t>(std::max<std::uint64_t>(memory, 1 << 20));
  return limits;
}

/// Returns the bytes of a file for a child, or the error.
std::variant<SharedBytes, std::string> file_for_child(const ImportSource& source, const std::string& reference) {
  if (!source.read_file) return std::string("files that it refers to cannot be read here");
  return source.read_file(reference);
}

std::variant<std::vector<std::byte>, std::string> import_by_child(const ContentType& type, const ImportSource& source) {
  DecoderPool& pool = DecoderPool::of_program();
  auto process = pool.take(DecoderKind::pictures);
  const std::vector<std::byte> header = transfer_bytes(import_request(type, source));
  if (!process->load(header, source.bytes)) return std::string("no memory to read it");
  DecodeRequest request = request_of(DecodeOperation::import_file, header.size() + source.bytes.size());
  request.count = header.size();
  const auto stopped = [&source] { return source.budget->stopped(); };
  auto answered = process->ask(request, stopped, kImportPatience);
  std::size_t references = 0;
  while (const auto* const answer = std::get_if<DecodeAnswer>(&answered)) {
    if (answer->good != DecodeAnswer::kAsksForFile) break;
    if (++references > kMostReferences) return std::string("it refers to too many files");
    const auto file = file_for_child(source, error_in(*answer));
    DecodeRequest reply = request_of(DecodeOperation::give_file, 0);
    std::span<const std::byte> bytes;
    if (const auto* const found = std::get_if<SharedBytes>(&file)) {
      bytes = found->bytes;
      reply.count = 1;
    } else {
      const std::string& error = std::get<std::string>(file);
      bytes = std::as_bytes(std::span(error.data(), error.size()));
    }
    reply.bytes = bytes.size();
    if (!process->put_result(bytes)) return std::string("no memory for a file that it refers to");
    answered = process->ask(reply, stopped, kImportPatience);
  }
  if (const auto* const error = std::get_if<render::ImageError>(&answered)) return error->message;
  auto bytes =
      process->take_bytes(std::get<DecodeAnswer>(answered), stopped, kImportPatience, source.budget->limits().memory);
  if (auto* const error = std::get_if<render::ImageError>(&bytes)) return std::move(error->message);
  pool.give_back(DecoderKind::pictures, std::move(process));
  return std::move(std::get<std::vector<std::byte>>(bytes));
}

}  // namespace

Asset read_confined(const ContentType& type, const ImportSource& source) {
  if (!is_confined(type, source)) return type.read(source);
  const auto result = import_by_child(type, source);
  if (const auto* const bytes = std::get_if<std::vector<std::byte>>(&result)) return asset_of(*bytes, source);
  if (!source.budget->stopped())
    source.diagnostics.add({Severity::error, source.path, {}, std::get<std::string>(result)});
  return {};
}

std::vector<std::byte> import_in_child(std::span<const std::byte> request, std::span<const std::byte> file,
                                       const AskForFile& ask) {
  Diagnostics diagnostics;
  const auto known = import_request_of(request);
  if (!known) return {};
  const auto types = content_types();
  const auto type = std::ranges::find(types, known->type, &ContentType::name);
  if (type == types.end() || !type->read) return {};
  const WorldBudget budget = std::make_shared<Budget>(limits_of(known->left));
  const ReadFile read_file = known->reads_files ? ReadFile([&ask](const std::string& reference) -> BytesResult {
    std::string error;
    if (auto bytes = ask(reference, error)) return shared_bytes(std::move(*bytes));
    return error;
  })
                                                : ReadFile();
  ImportSource source{file, known->path, read_file, budget, diagnostics, known->name, known->component, known->for_x3d};
  const Asset asset = type->read(source);
  if (!can_transfer(asset)) return {};
  return transfer_bytes(asset, diagnostics);
}

}  // namespace gs::app
