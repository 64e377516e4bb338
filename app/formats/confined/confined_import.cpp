#include "app/formats/confined/confined_import.h"

#include "app/confined/decoder_pool.h"
#include "app/formats/confined/asset_transfer.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/volume/volume_common.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::chrono::minutes kImportPatience{10};  // the limits of a world stop it earlier
constexpr std::size_t kMostReferences = 10'000;      // files that one file may ask for

bool is_confined(const ContentType& type, const ImportSource& source) {
  const bool imported = type.content == ContentClass::mesh || type.content == ContentClass::splats;
  return imported && !DecoderPool::of_program().program().empty() &&
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
  request.left = left_of(*source.budget);
  return request;
}

/// Returns a file for a child, or the error.
BytesResult file_for_child(const ImportSource& source, const std::string& reference) {
  if (!source.read_file) return std::string("files that it refers to cannot be read here");
  return source.read_file(reference);
}

std::variant<std::vector<std::byte>, std::string> import_by_child(const ContentType& type, const ImportSource& source) {
  DecoderPool& pool = DecoderPool::of_program();
  const bool with_module = type.read == read_dataset_mesh && needs_dataset_module(source.path, source.bytes);
  const DecoderKind kind = with_module ? DecoderKind::dataset_meshes : DecoderKind::pictures;
  auto process = pool.take(kind);
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
    answered = process->give_file(file_for_child(source, error_in(*answer)), stopped, kImportPatience);
  }
  if (const auto* const error = std::get_if<render::ImageError>(&answered)) return error->message;
  auto bytes =
      process->take_bytes(std::get<DecodeAnswer>(answered), stopped, kImportPatience, source.budget->limits().memory);
  if (auto* const error = std::get_if<render::ImageError>(&bytes)) return std::move(error->message);
  pool.give_back(kind, std::move(process));
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
                                       const ReadFile& ask) {
  Diagnostics diagnostics;
  const auto known = import_request_of(request);
  if (!known) return {};
  const auto types = content_types();
  const auto type = std::ranges::find(types, known->type, &ContentType::name);
  if (type == types.end() || !type->read) return {};
  const WorldBudget budget = std::make_shared<Budget>(limits_of(known->left));
  const ReadFile read_file = known->reads_files ? ask : ReadFile();
  ImportSource source{file, known->path, read_file, budget, diagnostics, known->name, known->component, known->for_x3d};
  source.component.found = std::make_shared<DatasetList>();
  // Volumes have children of their own, so that a type of both kinds means a mesh.
  const Asset asset = (type->mesh_type ? type->mesh_type : &*type)->read(source);
  if (!can_transfer(asset)) return {};
  return transfer_bytes(asset, diagnostics, *source.component.found);
}

}  // namespace gs::app
