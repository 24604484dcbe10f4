// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/scenes/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cctype>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/io/image_io.h"

namespace stillpoint::synth {
namespace {

namespace fs = std::filesystem;

constexpr float kMostRepeats = 1e4F;  // of a texture

Eigen::Vector3f vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

std::uint32_t color_of(const aiColor4D& color) {
  const auto byte = [](float value) {
    return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
  };
  return Texture::packed({byte(color.r), byte(color.g), byte(color.b)});
}

/// The image with the sides of a texture. @throws InputError if it cannot be read
cv::Mat texture_image(const fs::path& file) {
  constexpr int kLargest_px = 8192;
  cv::Mat image = datasets::read_image(file);
  if (image.channels() == 1) cv::cvtColor(image, image, cv::COLOR_GRAY2RGB);
  const auto side = [&](int px) {
    return std::min(kLargest_px, static_cast<int>(std::bit_ceil(static_cast<unsigned>(px))));
  };
  const cv::Size size(side(image.cols), side(image.rows));
  cv::resize(image, image, size, 0.0, 0.0, size.width < image.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return image;
}

/// Adds the meshes of a file to the one of a world.
class MeshCollector {
 public:
  MeshCollector(fs::path file, World& world, std::size_t max_texels)
      : file_(std::move(file)), world_(world), texels_left_(max_texels) {}

  void add(const aiScene& scene, const aiMesh& mesh) {
    if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0)
      return;  // points and lines beside the surfaces
    const std::optional<int> texture = texture_of(scene, mesh);
    if (!texture && !mesh.HasVertexColors(0)) {
      throw InputError(file_.string(),
                       "has triangles with neither vertex colors nor a texture, on which nothing "
                       "can be tracked; export the mesh with its colors");
    }
    StaticMesh& target = world_.mesh;
    const auto first = static_cast<std::uint32_t>(target.vertices.size());
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      target.vertices.push_back(vector_of(mesh.mVertices[i]));
      if (!target.vertices.back().allFinite())
        throw InputError(file_.string(), fmt::format("vertex {} is not finite; repair the mesh", first + i));
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      MeshTriangle triangle =
          texture ? textured(mesh, mesh.mFaces[i], *texture) : colored(mesh, mesh.mFaces[i]);
      for (int corner = 0; corner < 3; ++corner)
        triangle.corners[corner] = first + mesh.mFaces[i].mIndices[corner];
      target.triangles.push_back(triangle);
    }
  }

 private:
  /// Number of the texture of a mesh in the world; nothing if it has none.
  std::optional<int> texture_of(const aiScene& scene, const aiMesh& mesh) {
    aiString name;
    const aiMaterial& material = *scene.mMaterials[mesh.mMaterialIndex];
    if (!mesh.HasTextureCoords(0) || material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != aiReturn_SUCCESS)
      return {};
    std::string path = name.C_Str();
    std::ranges::replace(path, '\\', '/');  // of programs on Windows
    const fs::path image = file_.parent_path() / path;
    const auto [found, is_new] = textures_.try_emplace(image, static_cast<int>(world_.textures.size()));
    if (is_new) add_texture(image);
    return found->second;
  }

  void add_texture(const fs::path& image) {
    if (!fs::exists(image))
      throw InputError(file_.string(),
                       "names the texture " + image.string() +
                           ", which does not exist; copy it there, or export it with the mesh");
    const cv::Mat texture = texture_image(image);
    if (texture.total() > texels_left_)
      throw InputError(file_.string(), fmt::format("has too many pixels in {} textures, with {}; reduce the "
                                                   "sizes of the images",
                                                   world_.textures.size() + 1, image.string()));
    texels_left_ -= texture.total();
    world_.textures.emplace_back(texture);
  }

  [[nodiscard]] MeshTriangle textured(const aiMesh& mesh, const aiFace& face, int texture) const {
    MeshTriangle triangle{.texture = texture};
    const Texture& image = world_.textures[static_cast<std::size_t>(texture)];
    std::array<Eigen::Vector3f, 3> p;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const aiVector3D& uv = mesh.mTextureCoords[0][face.mIndices[corner]];
      if (!(std::abs(uv.x) < kMostRepeats && std::abs(uv.y) < kMostRepeats))
        throw InputError(file_.string(),
                         "has texture coordinates that are not finite or beyond 10000; repair the mesh");
      triangle.uv[corner] = {uv.x, 1.0F - uv.y};  // files count rows from the lower edge
      p[corner] = vector_of(mesh.mVertices[face.mIndices[corner]]);
    }
    const Eigen::Vector2f side = triangle.uv[1] - triangle.uv[0], other = triangle.uv[2] - triangle.uv[0];
    const auto texels = static_cast<float>(image.width()) * static_cast<float>(image.height()) *
                        std::abs(side.x() * other.y() - side.y() * other.x());
    const float area_m2 = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    triangle.texels_per_m = std::sqrt(texels / std::max(area_m2, 1e-12F));
    return triangle;
  }

  [[nodiscard]] static MeshTriangle colored(const aiMesh& mesh, const aiFace& face) {
    MeshTriangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner)
      triangle.colors[corner] = color_of(mesh.mColors[0][face.mIndices[corner]]);
    triangle.colors[3] = triangle.colors[2];
    return triangle;
  }

  fs::path file_;
  World& world_;
  std::map<fs::path, int> textures_;
  std::size_t texels_left_;
};

/// Calls `use` for each line of a text file, or of the header of a PLY, without the blanks before it.
template <class Use>
void for_each_line(const fs::path& file, const Use& use) {
  std::ifstream input(file, std::ios::binary);
  for (std::string line; std::getline(input, line) && line != "end_header" && line != "end_header\r";) {
    if (line.ends_with('\r')) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    use(line);
  }
}

bool is_same_letter(char a, char b) {
  return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// What follows a keyword, in any case as for Assimp, at the begin of a line.
std::vector<std::string> values_of(const fs::path& file, const std::string& keyword) {
  std::vector<std::string> values;
  for_each_line(file, [&](const std::string& line) {
    const bool is_found = std::ranges::equal(line.substr(0, keyword.size()), keyword, is_same_letter);
    const std::size_t value = is_found ? line.find_first_not_of(" \t", keyword.size()) : std::string::npos;
    if (value != std::string::npos)
      values.push_back(line.substr(value, line.find_last_not_of(" \t") + 1 - value));
  });
  return values;
}

/// A file that is named at the end of a line, after options of a texture; its name may contain blanks.
std::optional<fs::path> named_file(const fs::path& folder, std::string value) {
  std::ranges::replace(value, '\\', '/');
  for (std::size_t begin = 0; begin != std::string::npos;) {
    const fs::path file = folder / value.substr(begin);
    if (fs::is_regular_file(file)) return file;
    begin = value.find_first_of(" \t", begin);
    if (begin != std::string::npos) begin = value.find_first_not_of(" \t", begin);
  }
  return {};
}

constexpr const char* kPlyTexture = "comment TextureFile";

/// Assimp keeps coordinates per vertex, so that the last face of a vertex would determine those of all, and
/// one texture per PLY.
void require_readable_textures(const fs::path& file) {
  if (file.extension() != ".ply") return;
  for_each_line(file, [&](const std::string& line) {
    if (!line.starts_with("property list") || line.find("texcoord") == std::string::npos) return;
    throw InputError(file.string(),
                     "has texture coordinates per face, which are not read; export it as OBJ, or with "
                     "coordinates or colors per vertex");
  });
  if (const std::size_t textures = values_of(file, kPlyTexture).size(); textures > 1)
    throw InputError(file.string(), fmt::format("has {} textures, of which one is read; export it as OBJ, or "
                                                "with one texture",
                                                textures));
}

/// @throws InputError if a face names a vertex that the mesh lacks, which would be read out of bounds
void require_vertices_of_faces(const fs::path& file, const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const std::span corners(mesh.mFaces[f].mIndices, mesh.mFaces[f].mNumIndices);
      const auto wrong =
          std::ranges::find_if(corners, [&](unsigned index) { return index >= mesh.mNumVertices; });
      if (wrong == corners.end()) continue;
      throw InputError(file.string(),
                       fmt::format("face {} names vertex {} of {}, counted from 0; repair the mesh", f,
                                   *wrong, mesh.mNumVertices));
    }
  }
}

}  // namespace

std::vector<fs::path> companions_of_mesh(const fs::path& file) {
  std::vector<fs::path> files;
  const auto add = [&](const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      if (const auto named = named_file(file.parent_path(), name)) files.push_back(*named);
    }
  };
  if (file.extension() == ".ply") {
    add(values_of(file, kPlyTexture));
    return files;
  }
  add(values_of(file, "mtllib"));
  for (const fs::path& materials : std::vector(files)) add(values_of(materials, "map_Kd"));
  return files;
}

void read_mesh(const fs::path& file, World& world, std::size_t max_texels) {
  if (file.extension() != ".ply" && file.extension() != ".obj")
    throw InputError(file.string(), "is not named as a PLY or OBJ file; convert the mesh to .ply or .obj");
  if (!fs::is_regular_file(file)) throw InputError(file.string(), "no such file; check the path of --mesh");
  require_readable_textures(file);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene != nullptr) {
    require_vertices_of_faces(file, *scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                         aiProcess_PreTransformVertices);
  }
  if (scene == nullptr) {
    throw InputError(file.string(),
                     std::string("cannot be read as a mesh: ") + importer.GetErrorString() +
                         "; export it with faces (reconstruct the surface of a point cloud first)");
  }
  MeshCollector collector(file, world, max_texels);
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) collector.add(*scene, *scene->mMeshes[i]);
  if (world.mesh.triangles.empty())
    throw InputError(file.string(), "has no faces; reconstruct the surface of the point cloud first");
}

}  // namespace stillpoint::synth
