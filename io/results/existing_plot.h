// io/results/existing_plot.h – a plot file that is there already: may another one take its place unasked?
#pragma once
#include <string>
#include <vector>

#include "io/files/existing_model.h"
#include "src/model/joint_model.h"

namespace dea {

/// What a plot file of ours shows: the results of a run, what was recognised (dea info), results side by side.
enum class PlotKind { Run, Check, Comparison };

/// Why a plot file of this kind must not replace the one at `path` unless it is asked for, as what that one is: "it is
/// there already, written by FEBio4"; empty: it may. Of the same kind and ours, or empty, or none: it may.
std::string why_kept(const std::string& path, PlotKind kind);

/// The same of a run's plot file with states at `times`. Nor must it replace one of another mesh (other numbers of
/// nodes, of elements, or other parts), or with states at other times than these, which would be lost.
std::string why_kept(const std::string& path, const JointModel& model, const std::vector<double>& times);

}  // namespace dea
