"""Every fault by its name. Whoever writes another adds its row here."""

from tests.faults import ailing, ending, killing, soaking, unplugging
from tests.faults.row import FaultRow

ROWS: dict[str, FaultRow] = {
    "unplugging": unplugging.ROW,
    "ailing": ailing.ROW,
    "killing": killing.ROW,
    "ending": ending.ROW,
    "soaking": soaking.ROW,
}
