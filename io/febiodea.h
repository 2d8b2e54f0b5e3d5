// febiodea/febiodea.h – the front door: what the library offers, from a model's file to results in one.
//
// * read_feb: file -> JointModel (io/feb/read_feb.h)
// * recognise: JointModel, Settings -> Recognition (run/recognise.h)
// * analyse: Recognition -> Analysis (run/analysis.h)
// * make_plot_file: Recognition, Analysis -> XpltFile (io/results/plot_file.h)
// * write_xplt, read_xplt (io/xplt/xplt.h)
//
// and, for many load cases on one joint:
//
// * prepare: Recognition -> Prepared (run/prepared.h)
// * make_load_case: JointModel, Joint -> LoadCase (equilibrium/load_case.h)
// * solve: Prepared, LoadCase, Start -> Equilibrium
// * press: Prepared, poses -> pressures, force and moment on each body, their derivative
//
// Units are the model's own throughout; places are global, in the model's frame. Values own what they hold and may be
// used by several threads at a time. What takes long ends with Stopped when the flag it was given is set (base/stop.h).
// Faults of the user are thrown as InputError, UsageError and WriteError (base/error.h), each with one line that says
// what to do; recognise gives a model's faults as values instead.
#pragma once
#include <febiodea/base/error.h>
#include <febiodea/base/stop.h>
#include <febiodea/equilibrium/equilibrium.h>
#include <febiodea/equilibrium/load_case.h>
#include <febiodea/equilibrium/times.h>
#include <febiodea/io/feb/read_feb.h>
#include <febiodea/io/results/plot_file.h>
#include <febiodea/io/xplt/xplt.h>
#include <febiodea/model/settings.h>
#include <febiodea/results/fields.h>
#include <febiodea/results/statistics.h>
#include <febiodea/run/analysis.h>
#include <febiodea/run/check.h>
#include <febiodea/run/convergence.h>
#include <febiodea/run/prepared.h>
#include <febiodea/run/recognise.h>
#include <febiodea/run/states.h>
#include <febiodea/springs/place.h>
#include <febiodea/springs/press.h>
#include <febiodea/springs/wrench.h>
#include <febiodea/version.h>
