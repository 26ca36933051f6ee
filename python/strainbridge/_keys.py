"""Keys of a job by section, for editors and type checkers. Made by `python python/keys.py`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._section import Items, Section

if TYPE_CHECKING:
    from ._section import _Key


class BallastKeys(Section):
    """Keys of ``ballast``."""

    gravity: _Key[Any]
    """Acceleration of gravity [m/s2]; default: 9.80665."""
    masses: _Key[Any]
    """Number of masses; default: 1."""
    max_mass: _Key[Any]
    """Largest single mass [job unit of mass]; default: none."""
    properties: _Key[Any]
    """Properties whose grids may carry the masses, ids or names; default: all shells; bars if there are no shells."""
    region: _Key[Any]
    """Region in which the masses may be, [[x0, x1], [y0, y1]] [job unit of length]; default: the whole structure."""
    run: _Key[Any]
    """Run whose reactions are used; default: the first."""


class CalibrationKeys(Section):
    """Keys of ``calibration``."""

    angle_tolerance_deg: _Key[Any]
    """Tolerance of the angle of a gauge, one standard deviation. If it is stated, the runs determine the installed angle [deg]; default: 0."""
    check: _Key[Any]
    """Runs with known loads that S is not calibrated with. Their loads are recovered and compared. A column `check` of the runs file (true or
    false) does the same; default: none."""
    depends_on: _Key[Any]
    """Column of the runs file, such as speed: `calibrate` tests whether loads depend on it; default: none."""
    model_uncertainty_rel: _Key[Any]
    """Uncertainty of S of the model, one standard deviation, for each entry and common to a gauge, a fraction; default: 0.1."""
    position_tolerance: _Key[Any]
    """Tolerance of the position along and across the axis of a gauge, one standard deviation. If it is stated, the runs determine the installed
    position [job length]; default: 0."""
    repeats: _Key[Any]
    """Columns of the runs file: runs that are equal in these columns are repeats, and an error that they share counts once; default: runs of
    equal loads."""
    runs: _Key[Any]
    """Calibration runs; default: every run of [measured] whose loads [runs] gives."""
    scale_sd: _Key[Any]
    """Relative error that the known loads of all runs share, one standard deviation, a fraction: one scale or one load cell measured them all.
    Columns <load>_sd state errors that are independent from run to run; default: 0."""
    terms: _Key[Any]
    """Model of the strain: 'linear' is S f, 'intercept' adds the strain that each gauge reads without load; default: linear."""


class CandidatesKeys(Section):
    """Keys of ``candidates``."""

    angle_step_deg: _Key[Any]
    """Step of angles from the element x axis, or 'continuous' [degree]; default: 15."""
    boxes: _Key[Any]
    """Boxes in which gauges may be placed, [[x0, x1], [y0, y1], [z0, z1]] each [job unit of length]; default: anywhere."""
    bridge: _Key[Any]
    """Wirings to choose from; default: quarter."""
    clear_of: _Key[Any]
    """Minimum distances from places that disturb the strain or the technician; default: none."""
    elements: _Key[Any]
    """Element ids, such as '1 THRU 5000'; default: all."""
    exclude_boxes: _Key[Any]
    """Boxes in which no gauge may be placed [job unit of length]; default: none."""
    exclude_elements: _Key[Any]
    """Elements left out; default: none."""
    exclude_properties: _Key[Any]
    """Properties left out, ids or names; default: none."""
    file: _Key[Any]
    """A name that ends with .toml: file with a section [candidates] whose lists of properties and elements (properties, elements,
    exclude_properties, exclude_elements, wanted_elements) are added to those of the job. It may also state [placement] gauges and keep, which
    replace the values of the job. Any other name: table of named spots, with the columns of [gauges] file and an optional column `cost`. Gauges
    are chosen from these spots alone and keep their names; other keys of [candidates] are refused. Costs need [placement] budget; default:
    none."""
    grid_length: _Key[Any]
    """Grid length of the gauges to be placed; written to gauges.csv. The layout and its sigmas are computed with the strain at the middle of
    each gauge, its spread over the grid counts as scatter; S and the strain by load of the chosen gauges are averaged over the grid. A place
    where the grid does not fit is replaced [job unit of length]; default: 0."""
    properties: _Key[Any]
    """Property ids, or names of the deck as `check` shows them; default: all."""
    rosette: _Key[Any]
    """Whether rosettes are candidates as well; default: none."""
    sets: _Key[Any]
    """SETs of the deck's case control that name the elements; default: not limited so."""
    surfaces: _Key[Any]
    """Sides of shells; default: both."""
    wanted_elements: _Key[Any]
    """Elements that must each receive a gauge. Only for single gauges of one bridge type, without costs or a budget; default: none."""


class CombinationKeys(Section):
    """Keys of ``combination``."""

    name: _Key[Any]
    """Name of the combination in tables and reports of `recover`, `calibrate`, `place` and `fleet`; required."""
    terms: _Key[Any]
    """Factor by load, such as { 'LF.FZ' = 1, 'RF.FZ' = 1 }; required."""


class CompareKeys(Section):
    """Keys of ``compare``."""

    columns: _Key[Any]
    """Column of a load, if the file names it differently; default: the name of the load."""
    file: _Key[Any]
    """Record of loads (any format of records), or runs with a column `run`; required."""
    noise: _Key[Any]
    """Noise of the recorded loads, one standard deviation: it widens the intervals of `share_within` [the file's units]; default: none."""
    shift_s: _Key[Any]
    """Time added to the times of the file to get those of the strain record: a number, or 'estimate' from the loads of both [s]; default:
    estimate."""
    time_unit: _Key[Any]
    """Unit of the column `time`, if the file states none; default: s, or what the size of the times shows."""
    units: _Key[Any]
    """Units of the file; a column that states another unit is a fault; default: the units of the columns, else report_units."""


class ConditioningKeys(Section):
    """Keys of ``conditioning``."""

    drift: _Key[Any]
    """linear: the least squares line of each gauge over the record is subtracted, so that it is zero in `zero_s`, or at the first sample;
    default: none."""
    high_pass_hz: _Key[Any]
    """Corner of the same filter as a high-pass. Static loads are removed with the static strain [Hz]; default: none."""
    low_pass_hz: _Key[Any]
    """Corner of a Butterworth filter of order 4, run forward and backward: half the amplitude at the corner, no phase shift [Hz]; default:
    none."""
    spikes: _Key[Any]
    """Single samples far off the line through their neighbours are replaced by that line, and counted; default: false."""
    temperature: _Key[Any]
    """Apparent strain that follows a temperature channel is subtracted, relative to the mean temperature in `zero_s`, or to the first sample;
    default: none."""
    zero_s: _Key[Any]
    """Stretch of the record, [start, end], whose mean is zero for each gauge; it replaces [measured] `zero`, and needs 100 independent readings
    [s]; default: none."""


class CorrectionKeys(Section):
    """Keys of ``correction``."""

    angle_deg: _Key[Any]
    """Angle from the nominal to the installed direction, right-handed about the element normal [degree]; default: 0."""
    exchanged_with: _Key[Any]
    """Gauge that has the column of this gauge, and whose column this gauge has; default: none."""
    gain: _Key[Any]
    """Reading over strain: 0.7 reads 0.7 of the strain; default: 1."""
    gauge: _Key[Any]
    """The gauge, by name; a rosette means its three legs, `R1.a` one leg; required."""
    ignore: _Key[Any]
    """Leave the channel out; default: false."""
    offset_microstrain: _Key[Any]
    """Reading of the channel without strain; subtracted [microstrain]; default: 0."""
    sign: _Key[Any]
    """-1: the channel reads with the wrong sign; default: 1."""


class DynamicKeys(Section):
    """Keys of ``dynamic``."""

    damping: _Key[Any]
    """Damping of the modes, share of critical: a number, a list of bands [{ up_to_hz, damping }], or 'estimate' from the record; required."""
    damping_uncertainty_rel: _Key[Any]
    """One standard deviation of the damping, as a fraction of it; default: 0.5."""
    frequency_uncertainty_rel: _Key[Any]
    """One standard deviation of the frequencies of the modes, as a fraction of each; default: 0.02."""
    up_to_hz: _Key[Any]
    """Upper frequency of the recovered loads. The filter rolls off to zero at 1.5 times this frequency [Hz]; required."""


class FleetKeys(Section):
    """Keys of ``fleet``."""

    file_name: _Key[Any]
    """Form of the paths of records: text with {vehicle} and {day}, and {any} for a part without meaning. Folders count if the form contains /:
    vehicle={vehicle}/day={day}/{any}.parquet; required."""
    knee_range: _Key[Any]
    """Load range below which the S-N line is flatter [report unit of each load]; default: no knee."""
    mission: _Key[Any]
    """Kind of days of a mission. The damage of the mission is extrapolated from the kinds and their shares."""
    mission_hours: _Key[Any]
    """Hours of the mission [h]; default: 1."""
    reference: _Key[Any]
    """Day whose damage per hour is 1; default: none."""
    slope_below_knee: _Key[Any]
    """Power below the knee; default: cycles below do no harm."""
    target: _Key[Any]
    """Target damage by load, such as { 'A.FZ' = 1.2e12 } [report unit to the power of the slope]; default: none."""


class GaugeKeys(Section):
    """Keys of ``gauge``."""

    angle_deg: _Key[Any]
    """Angle from `direction`, right-handed about the element normal [degree]; default: 0."""
    bridge: _Key[Any]
    """Wiring of the arms; default: quarter."""
    bridge_factor: _Key[Any]
    """Number that divides the sum of the signed arm strains; default: 1."""
    cid: _Key[Any]
    """Coordinate system of position and direction. The axes of a cylindrical or spherical system are those at the gauge; default: 0, basic."""
    direction: _Key[Any]
    """Direction of the axis, projected onto the surface; default: x axis of the element."""
    element: _Key[Any]
    """Shell or bar of the gauge."""
    element2: _Key[Any]
    """Element of the other pair of a bridge; default: the element of the gauge."""
    grid_length: _Key[Any]
    """Length over which strain is averaged, at most the length of the part [job unit of length]; default: 0: at the point."""
    name: _Key[Any]
    """Column of the gauge in the strain file; names differ by more than case and spaces; required."""
    point: _Key[Any]
    """Recovery point of a bar or beam; required on bars."""
    position: _Key[Any]
    """Point instead of an element: the shell with the nearest skin is used and reported [job unit of length]."""
    role: _Key[Any]
    """estimate: loads are estimated from it. validation, or reserve: never used for loads, `recover` compares it with its prediction; default:
    estimate."""
    rosette: _Key[Any]
    """Three legs instead of one grid; columns `<name>.a`, `.b`, `.c`; default: none."""
    station: _Key[Any]
    """Place along a bar or beam, share of its length from end A; only together with `point`. Results must contain the station if PLOAD1 acts on
    the bar or its section changes; default: 0."""
    surface: _Key[Any]
    """Side of a shell: top is Z2, bottom is Z1; default: with `position` the side of the nearest skin, else top."""
    surface2: _Key[Any]
    """Side of the other pair of a bridge; default: the side that faces away from the first pair."""
    transverse_sensitivity: _Key[Any]
    """Transverse sensitivity Kt, a fraction; default: 0."""


class GaugesKeys(Section):
    """Keys of ``gauges``."""

    file: _Key[Any]
    """CSV with the keys of [[gauge]] as columns (dir_x, dir_y, dir_z; x, y, z), as `place` writes it; required."""


class LoadKeys(Section):
    """Keys of ``load``."""

    applied: _Key[Any]
    """Size of the load in its subcase, signed [job unit of force or moment]; default: 1."""
    cid: _Key[Any]
    """Coordinate system of the component; default: 0, basic."""
    component: _Key[Any]
    """Force or moment component, in the basic frame or the frame of `cid`; required with grid."""
    expected: _Key[Any]
    """Expected size of the load, one standard deviation: scales the loads in `place`, and is the prior of nuisance loads [job unit of force or
    moment]; default: none."""
    grid: _Key[Any]
    """Grid where the load acts."""
    load_set: _Key[Any]
    """Load set of the deck, instead of a grid."""
    name: _Key[Any]
    """Name of the load in tables and reports; required."""
    result: _Key[Any]
    """Results file of the load, if there are several; default: the one that holds the subcase."""
    role: _Key[Any]
    """wanted, or nuisance: present but not asked for; default: wanted."""
    subcase: _Key[Any]
    """Subcase in the results; default: its number in the job."""
    weight: _Key[Any]
    """Weight of the variance of this load in criterion A; default: 1."""


class MeasuredKeys(Section):
    """Keys of ``measured``."""

    hold_out: _Key[Any]
    """Runs, or a second file, that no fit uses; default: none."""
    model_uncertainty_rel: _Key[Any]
    """Error of the predicted strain, one standard deviation, a fraction; default: 0."""
    noise_correlation: _Key[Any]
    """Correlation of the noise of any two gauges, 0 to less than 1: what they have in common, such as hum or a common supply; default: 0, or
    what a zero record or the residuals of many runs show."""
    noise_microstrain: _Key[Any]
    """Noise of a reading, one standard deviation: one number, or one for each gauge such as { G1 = 0.5, G2 = 1.2 } [microstrain]; default:
    1."""
    reference: _Key[Any]
    """none: loads are changes. gravity, or a subcase (of the results; without results, of the deck): its strain is added, and loads are totals;
    default: none."""
    strain: _Key[Any]
    """CSV, Parquet, Feather, RPC III, MDF4 or binary record, XLSX of runs; one column for each gauge; one row for each sample (`time`) or run
    (`run`) [microstrain, or the unit after the gauge's name or in a row below the names]; required."""
    time_unit: _Key[Any]
    """Unit of the column `time`, if the file states none; default: s, or what the size of the times shows (serial days, time since 1970)."""
    zero: _Key[Any]
    """Record or runs whose mean is subtracted [microstrain]; default: none."""
    zero_runs: _Key[Any]
    """Runs of the strain file without load, instead of `zero`: the zero is interpolated linearly between them. A second file of held-out runs
    must contain some of these runs; default: none."""


class ModelKeys(Section):
    """Keys of ``model``."""

    deck: _Key[Any]
    """Nastran deck, or an OP2 that contains the mesh; path relative to the job; required."""
    mesh_error: _Key[Any]
    """Whether the built-in solver also solves a mesh of half the width (four times the grids, about five times the time). S is then the limit
    of the strain for finer meshes, and `recover` and `place` include the uncertainty of this limit; default: true for shells, up to 13,000
    grids and loads that do not act directly on a shell."""
    results: _Key[Any]
    """OP2, HDF5 or punch files with strain of the unit loads; default: the built-in solver computes them."""
    support: _Key[Any]
    """Support of the structure: 'deck' (the SPC set that case control selects, if any, else free), 'free' (inertia relief), or the id of an SPC
    set. Springs to ground (CELAS, CBUSH) hold what they resist in each case. Inertia balances loads along the other rigid motions; default:
    deck."""


class PayloadKeys(Section):
    """Keys of ``payload``."""

    gravity: _Key[Any]
    """Acceleration of gravity [m/s2]; default: 9.80665."""
    grid: _Key[Any]
    """Grid where the payload acts; required with a model."""
    nominal_x: _Key[Any]
    """Place along x that the signatures were computed for [job unit of length]; default: the coordinate of the grid."""
    nominal_y: _Key[Any]
    """Place along y that the signatures were computed for [job unit of length]; default: the coordinate of the grid."""
    position: _Key[Any]
    """Whether the place of the payload is known; default: known."""
    region: _Key[Any]
    """Region in which the payload may be, [[x0, x1], [y0, y1]] [job unit of length]; default: the whole structure."""
    unloaded: _Key[Any]
    """Run without payload: its wheel forces, and its strain if there is no zero file, are subtracted; default: none."""
    use: _Key[Any]
    """Measurements that determine the payload; default: both where present."""
    weight_in_model: _Key[Any]
    """Whether the model already contains the weight of the payload; default: true."""


class PlacementKeys(Section):
    """Keys of ``placement``."""

    angle_tolerance_deg: _Key[Any]
    """Tolerance of the angle, one standard deviation [degree]; default: 0."""
    budget: _Key[Any]
    """Largest cost of a layout. With a table of spots it is in the unit of the column `cost`, and replaces `gauges` [channels, or money];
    default: gauges."""
    costs: _Key[Any]
    """Cost by wiring (quarter, half-bending, full-bending, shear, rosette) [channels, or money]; default: 1; a rosette 3."""
    criterion: _Key[Any]
    """Quantity that the layout optimises: all loads (D), the wanted loads (Ds), mean variance (A), mean error of predicted strain (I), loads of
    known size (Bayesian-D), or the condition number; default: Ds with nuisance loads, else D."""
    curve: _Key[Any]
    """Gauge counts for which sigma, bound and condition number are reported; default: none."""
    gauge_factor_rel: _Key[Any]
    """Tolerance of the gauge factor, one standard deviation, a fraction; default: 0."""
    gauges: _Key[Any]
    """Number of gauges; default: twice the number of loads."""
    keep: _Key[Any]
    """Installed gauges that stay: 'all', or their names. `gauges` counts only the added ones; default: none."""
    loss: _Key[Any]
    """judge: report sigma after the loss of any one gauge. optimise: choose the layout that is best after the worst loss of one gauge; default:
    judge."""
    model_uncertainty_rel: _Key[Any]
    """Error of the predicted strain, one standard deviation, a fraction; default: the value of [measured], else 0."""
    noise_by_bridge: _Key[Any]
    """Noise by wiring, such as { full-bending = 0.5 } [microstrain]; default: noise_microstrain."""
    noise_microstrain: _Key[Any]
    """Noise of a gauge, one standard deviation [microstrain]; default: the value of [measured], else 1."""
    position_tolerance: _Key[Any]
    """Tolerance of the position along each direction, one standard deviation [job unit of length]; default: 0."""
    references: _Key[Any]
    """Named grids from which the gluing sheet measures distances; default: grids where loads act."""
    reserve: _Key[Any]
    """Number of gauges reserved for validation; default: 0."""
    seed: _Key[Any]
    """Seed of all random numbers; default: 1."""
    spacing: _Key[Any]
    """Minimum distance between gauges [job unit of length]; default: 0."""
    symmetric: _Key[Any]
    """Axis normal to a plane through 0: gauges are placed in pairs that mirror each other there; default: none."""


class ReconcileKeys(Section):
    """Keys of ``reconcile``."""

    causes: _Key[Any]
    """Causes measured together with the readings: name, and column of the runs file; default: none."""
    effect: _Key[Any]
    """A hypothesis of the user, tested like the effects of the library."""
    effects: _Key[Any]
    """Effect ids to test, or 'all'; default: all."""
    joints: _Key[Any]
    """Bushes whose stiffness may be wrong; default: all, where they are few."""
    path: _Key[Any]
    """Strain of runs, or accelerations; required."""
    places: _Key[Any]
    """Grids where a mass may be, by name; default: none."""
    temperature_set: _Key[Any]
    """Temperature set of the deck for the effect thermal_gradient; default: none."""
    thermal_microstrain_per_degC: _Key[Any]
    """Apparent strain by wiring, such as { quarter = 1.4 } [microstrain per degC]; default: 0."""
    tolerance: _Key[Any]
    """Tolerances of the installed gauges, one standard deviation; default: none."""
    zones: _Key[Any]
    """Properties whose stiffness may be wrong together, ids or names of the deck, such as { L4 = [14], left = 'RailLeft' }; default: each
    property with gauges."""


class RecoverKeys(Section):
    """Keys of ``recover``."""

    csv_every: _Key[Any]
    """Step between the samples in `loads.csv`: 10 writes every tenth sample; default: 1."""
    files: _Key[Any]
    """Files to write; default: all, but for long histories."""
    slope: _Key[Any]
    """Power of the load range in pseudo-damage; default: 5."""
    turning_points: _Key[Any]
    """Share of the range of a load below which its reversals are left out. If it is stated, `turning_points.csv` contains the samples in which
    any load of a record turns. All loads are stated at these times, so that their phase is kept; default: no such file."""


class ReportUnitsKeys(Section):
    """Keys of ``report_units``."""

    force: _Key[Any]
    """Unit of forces in reports; default: the unit of `units`."""
    length: _Key[Any]
    """Unit of lengths in reports; default: the unit of `units`."""
    mass: _Key[Any]
    """Unit of masses in reports; default: the unit of `units`."""
    moment: _Key[Any]
    """Unit of moments in reports; default: the unit of `units`."""
    stress: _Key[Any]
    """Unit of stress in reports; default: the unit of `units`."""


class RespondKeys(Section):
    """Keys of ``respond``."""

    elements: _Key[Any]
    """Elements to report, such as '1 THRU 500'; default: the hottest."""
    fatigue_class: _Key[Any]
    """Stress range that the detail endures for 2 million cycles, such as the FAT class of a weld. If it is stated, `fatigue.csv` contains the
    share of the life that the record uses: the sum of n / N with N = 2e6 (class / range)^slope, without an endurance limit; needs `slope`
    [report unit of stress]; default: no share of life."""
    hottest: _Key[Any]
    """Number of elements with the highest stress to report; default: 20."""
    loads: _Key[Any]
    """Table or record of loads, as `recover` writes them (loads.csv, loads.bin, loads.rsp, loads.parquet) or reads them. A record has no
    intervals, and its loads count as exact [report units]; default: recovered from [measured]."""
    mean_sensitivity: _Key[Any]
    """Sensitivity M to mean stress for mean_stress = 'sensitivity', such as 0.3; required for 'sensitivity'."""
    mean_stress: _Key[Any]
    """Correction of `fatigue` for the mean stress of each cycle: 'none', 'goodman', 'swt' (Smith, Watson, Topper), 'sensitivity' (M of the FKM
    guideline); default: 'none'."""
    slope: _Key[Any]
    """Power of the stress range in pseudo-damage. If it is stated, `fatigue.csv` contains the damage at each reported place over the history of
    loads; default: no damage."""
    ultimate: _Key[Any]
    """Ultimate strength for mean_stress = 'goodman' [report unit of stress]; required for 'goodman'."""


class RunsKeys(Section):
    """Keys of ``runs``."""

    columns: _Key[Any]
    """Column of a load or payload quantity, if the file names it differently; default: the name of the load or channel."""
    file: _Key[Any]
    """CSV with `run`, one column for each load, payload_force, payload_mass, payload_x, payload_y; required."""
    ground: _Key[Any]
    """Typical change of a computed wheel force by ground that is not flat, one standard deviation. `reconcile` estimates this change for every
    run [the file's unit of force]; default: none."""
    noise: _Key[Any]
    """Noise of the numbers in the file, one standard deviation. If columns state another unit than report_units, set runs.units [the file's
    units]; default: 1 %, with a finding."""
    units: _Key[Any]
    """Units of the file; a column that states another unit (`LF.FZ [N]`) is a fault; default: the units of the columns, else report_units."""
    wheel_forces: _Key[Any]
    """Source of the wheel forces: measured, or computed for flat ground (then they are no evidence); default: measured."""


class SectionKeys(Section):
    """Keys of ``section``."""

    at_least_s: _Key[Any]
    """Shortest stretch that counts, together with `within` [s]; default: 0."""
    end_s: _Key[Any]
    """Time at which the section ends; a sample at this time belongs to the next section [s]; required without `file` or `within`."""
    file: _Key[Any]
    """A separate strain record, instead of times, with the columns, zero and corrections of [measured]; default: none."""
    name: _Key[Any]
    """Name of the section; required."""
    repeats: _Key[Any]
    """Number of repetitions in the duty cycle; default: 1."""
    start_s: _Key[Any]
    """Time of the first sample of the section [s]; required without `file` or `within`."""
    within: _Key[Any]
    """Range [low, high] of one or more channels of the strain record, such as { speed = [5.0, inf] } or { lat = [51.20, 51.21], lon = [4.40,
    4.42] }. The section is all stretches in which every channel is within its range [unit of the channel]; default: none."""


class SensitivityKeys(Section):
    """Keys of ``sensitivity``."""

    columns: _Key[Any]
    """Column of a load, if the file names it differently; default: the name of the load or channel."""
    common_zero: _Key[Any]
    """CSV with the columns gauge and common_zero: strain that the gauges read without load, as `calibrate` writes it with terms = 'intercept'.
    It is subtracted from all readings [microstrain]; default: none."""
    covariance: _Key[Any]
    """Uncertainty of this S: calibration.bin, as `calibrate` writes it; default: exact."""
    file: _Key[Any]
    """CSV with one row for each gauge (column gauge) and one column for each load [microstrain per load]; required."""
    per: _Key[Any]
    """Units of the loads in S; default: job units, not report_units."""
    range: _Key[Any]
    """Smallest and largest load of the calibration by load, such as { 'LF.FZ' = [0, 12] }, as `calibrate` writes it: `recover` and `payload`
    report loads beyond it [the units of `per`]; default: not tested."""
    signatures: _Key[Any]
    """Signatures of effects of size one, computed elsewhere; default: none."""
    strain_range: _Key[Any]
    """Smallest and largest reading of the calibration by gauge, as `calibrate` writes it: `recover` reports readings far beyond it
    [microstrain]; default: not tested."""


class StudyKeys(Section):
    """Keys of ``study``."""

    errors: _Key[Any]
    """Errors of readings and gluing; required."""
    gauges: _Key[Any]
    """Gauge counts; default: all of the job."""
    layouts: _Key[Any]
    """given: the first n gauges of the job; random; D, Ds: the best; default: given, random, D."""
    seed: _Key[Any]
    """Seed of all random numbers; default: 1."""
    trials: _Key[Any]
    """Repetitions; default: 1000."""


class VehicleKeys(Section):
    """Keys of ``vehicle``."""

    band_hz: _Key[Any]
    """Band in which model and measurement are compared [Hz]; default: 0.7 to 20."""
    bounds: _Key[Any]
    """Limits [low, high] of parameters; `inf` if there is no limit. Masses, rates, damping and friction always stay above 0 [units of the job];
    default: none."""
    columns: _Key[Any]
    """Column of a channel, if the file names it differently; default: the name of the load or channel."""
    corrections: _Key[Any]
    """Known faults of channels, by channel; default: none."""
    data: _Key[Any]
    """CSV, RPC III, Parquet, Feather or MDF4 record: accelerations and wheel forces, in the units of the job if the file states none;
    required."""
    hold_out: _Key[Any]
    """Record of another road that no fit uses; default: none."""
    input: _Key[Any]
    """Input of `simulate`: 'wheel_force', 'road', 'acceleration', or a list of channels; default: the only kind of input that the record
    contains."""
    known: _Key[Any]
    """Known parameters, such as { m_b = 3200.0 } [units of the job]; default: none."""
    leaf: _Key[Any]
    """Leaf springs by link (s), whose force is divided between hanger and shackle; default: none."""
    mass_change: _Key[Any]
    """A mass that changes during the record; default: none."""
    model: _Key[Any]
    """Model of the vehicle; required."""
    noise: _Key[Any]
    """Noise of channels, one standard deviation; default: estimated from the record."""
    places: _Key[Any]
    """Places [x, y] of wheels (lf), springs (spring_lf) and body accelerometers (body_lf) [job unit of length]; default: the places of the
    model's preset."""
    sample_rate: _Key[Any]
    """Sample rate [Hz]; default: from the column time."""
    terms: _Key[Any]
    """Terms of the analyst's model, such as k_s, c_s; default: none."""
    tolerance: _Key[Any]
    """Declared tolerances of the measuring chain, one standard deviation; default: 0."""


class Keys:
    """Sections and keys of a job."""

    ballast: _Key[BallastKeys]
    """Lumped masses that bring the model's reactions to the measured ones."""
    calibration: _Key[CalibrationKeys]
    """Settings of `calibrate`, which computes S from runs with known loads."""
    candidates: _Key[CandidatesKeys]
    """Where `place` may put gauges; default: all shells."""
    combination: _Key[Items[CombinationKeys]]
    """A sum of loads, recovered with its own 95 % interval."""
    compare: _Key[CompareKeys]
    """Recorded loads that `recover` compares its loads with."""
    conditioning: _Key[ConditioningKeys]
    """Changes of the readings of a record after [[correction]] and before anything else, in the order of these keys. `result.json` states what
    each step changed; default: none."""
    correction: _Key[Items[CorrectionKeys]]
    """Known fault of a channel, corrected in every reading and record of the job."""
    dynamic: _Key[DynamicKeys]
    """Records with content near the elastic modes of the structure: `recover` removes the vibration with the modes of the model; default:
    readings are taken as at rest."""
    fleet: _Key[FleetKeys]
    """Records of many vehicles and days."""
    gauge: _Key[Items[GaugeKeys]]
    """An installed gauge."""
    gauges: _Key[GaugesKeys]
    """Installed gauges in a table."""
    load: _Key[Items[LoadKeys]]
    """A load to be recovered: a column of S."""
    measured: _Key[MeasuredKeys]
    """Measured strain."""
    model: _Key[ModelKeys]
    """The finite element model."""
    payload: _Key[PayloadKeys]
    """Payload mass and position."""
    placement: _Key[PlacementKeys]
    """Goal and limits of the search of `place`."""
    reconcile: _Key[ReconcileKeys]
    """Where simulation and measurement disagree."""
    recover: _Key[RecoverKeys]
    """Files that `recover` writes in addition to loads.csv."""
    report_units: _Key[ReportUnitsKeys]
    """Units of reports, such as { force = 'kN', moment = 'kN m' }; default: the units of `units`."""
    respond: _Key[RespondKeys]
    """Strain and stress anywhere from recovered loads."""
    runs: _Key[RunsKeys]
    """Other measurements of each run: wheel forces, payload."""
    section: _Key[Items[SectionKeys]]
    """A section of the record (a stretch of road, an event): `recover` reports loads, statistics and damage for each."""
    sensitivity: _Key[SensitivityKeys]
    """S computed elsewhere, instead of [model]. Together with [model] only if `covariance` states a calibrated S."""
    study: _Key[StudyKeys]
    """Recovery repeated under stated errors. The true loads are the loads of the first complete run; without one, each trial draws them from a
    normal distribution with standard deviation `expected`."""
    title: _Key[Any]
    """Title of reports; default: the job's file name."""
    units: _Key[Any]
    """Unit system of the deck, never guessed; required with a model."""
    vehicle: _Key[VehicleKeys]
    """A vehicle identified from accelerations."""
