// vdbtrace --shard: which pictures, or which pieces of them, are this process's, and which are there already.
#pragma once

#include "trace_options.h"

#include "shade/film/picture.h"
#include "shade/parts/part.h"

#include <cstddef>
#include <string>
#include <vector>

namespace stratum::tools {

/// "I/N", or "slurm": a task of an array, which says so in its environment; or "slurm/N": its number is that of the
/// task, of N, so that an array of some numbers makes some of the shards. Throws UsageError.
shade::Shard givenShard(const std::string& text);

/// The options that were given and may change what is made, as text for hashes: the same for any order of them.
std::string saidOf(const CLI::App& app);

/// Pictures that a command makes.
std::size_t pictures(const TraceCommand& command);

/// The file of picture n: numbered, and named by the shard if that traces only its piece of it.
std::string outputOf(const TraceCommand& command, std::size_t n);

/// Whether this process makes picture n.
bool makes(const TraceCommand& command, std::size_t n);

/// Reads --shard and --shard-by of commands whose options are parsed, and gives each its pictures. Throws UsageError.
void divide(std::vector<TraceCommand>& commands);

/// For pieces and for --resume: what each picture is made of, before anything is loaded; and with --resume leaves out
/// what is there. To be called when all options are decided. Throws UsageError and InputError.
void identify(TraceCommand& command);

/// A hash of all that the frames of a planned film depend on.
std::string filmIdentity(const TraceCommand& command);

/// Where --resume notes the finished pictures of a series; empty if it doesn't.
std::string recordOf(const TraceCommand& command);

/// Notes there that picture n is written. Throws OutputError.
void recordPicture(const TraceCommand& command, std::size_t n);

/// The render options of this process: of its piece, if it traces one.
shade::RenderOptions renderOptionsOf(const TraceCommand& command);

/// Writes the part of picture n with all that a merge needs.
/// @param metadata  of the finished picture
/// @param legend    of the finished picture; may be null
void writePiece(shade::PictureFile& file, const TraceCommand& command, std::size_t n, const shade::RenderResult& result,
                const shade::Metadata& metadata, const shade::Legend* legend);

}  // namespace stratum::tools
