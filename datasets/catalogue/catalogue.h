// SPDX-License-Identifier: BSD-3-Clause
/// Public datasets: where their archives are, how they are verified, and which sequences they contain.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint::datasets {

/// A file to download; usually an archive.
struct CatalogueArchive {
  std::string file;               ///< path below the base address of the dataset; unique in the dataset
  std::vector<std::string> urls;  ///< the first is preferred, the others are mirrors; empty: no download
  std::uint64_t bytes = 0;        ///< published size; 0 = not published
  std::string sha256;             ///< published, lower case; empty = not published
  std::string md5;                ///< published, lower case; empty = not published
};

struct CatalogueSequence {
  std::string name;                   ///< within the dataset, e.g. "fr3_walking_xyz"
  std::string group;                  ///< e.g. a scene; may be empty
  std::vector<std::string> archives;  ///< `CatalogueArchive::file`, extracted into one folder
  std::string folder;                 ///< of the sequence after extraction, relative
};

/// One catalogue file.
struct CatalogueDataset {
  std::string name;  ///< e.g. "tum"
  std::string title;
  std::string homepage;
  std::string licence;
  std::string citation;            ///< BibTeX
  std::string layout;              ///< name of the sequence format
  std::string user_agent;          ///< for hosts that reject unknown programs; empty = that of this program
  std::string md5_suffix;          ///< appended to an address: a text with the MD5 of the file; empty = none
  std::string token_variable;      ///< environment variable with an access token; empty = none
  std::string manual;              ///< how to fetch the files by hand, if a program cannot; empty otherwise
  std::string rig;                 ///< text of rig.toml, for layouts without calibration; empty = none
  std::vector<std::string> notes;  ///< what a user has to know about the files
  std::vector<CatalogueArchive> archives;
  std::vector<CatalogueSequence> sequences;
};

/// Parses a catalogue file. Its keys are those of `CatalogueDataset`, and:
///   urls = ["https://host/{}"]      base addresses; {} is replaced by the file
///   [[sequences]]                   members = ["a", "b"], and texts in which {} is replaced by a member:
///     name, folder (default "{}"), files = ["x/{}.tgz"], group
///   [archives."x/a.tgz"]            bytes, sha256, md5, urls = ["https://other/host"] (complete addresses)
/// @param place name of the text in messages
/// @throws InputError with file and line if the text is not ASCII or not valid TOML, a key is unknown, a
/// value has the wrong type, a name or digest is malformed, an address is not http(s), a path leaves its
/// folder, or a name occurs twice
[[nodiscard]] CatalogueDataset parse_catalogue(std::string_view text, const std::string& place);

/// The archive with this file name.
[[nodiscard]] const CatalogueArchive& archive_of(const CatalogueDataset& dataset, const std::string& file);

/// Name of a sequence in commands: "tum/fr3_walking_xyz".
[[nodiscard]] std::string catalogue_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence);

/// Name under which a sequence is registered for plans: "tum_fr3_walking_xyz".
[[nodiscard]] std::string registered_name(const CatalogueDataset& dataset, const CatalogueSequence& sequence);

/// Published size of several archives [bytes]; 0 if one of them is not known.
[[nodiscard]] std::uint64_t published_bytes(const CatalogueDataset& dataset,
                                            const std::vector<std::string>& files);

/// A sequence and its dataset, which must outlive it.
struct CatalogueEntry {
  const CatalogueDataset* dataset = nullptr;
  const CatalogueSequence* sequence = nullptr;
};

/// The sequences that a pattern selects: "tum/fr3_walking_*" (a glob), "tum_fr3_walking_xyz" (registered
/// name), "openloris/cafe" (dataset and group), or "tum" (all of a dataset). Empty if none.
[[nodiscard]] std::vector<CatalogueEntry> matching_entries(const std::vector<CatalogueDataset>& datasets,
                                                           const std::string& pattern);

}  // namespace stillpoint::datasets
