//! The node's services, all of the kind `std_srvs/Trigger`: the answer comes when the work is done, with the reason if it is
//! not. An emergency stop waits for none of the others.

use super::RosError;
use super::messages::{TriggerRequest, TriggerResponse};
use fivebar_sim::drive::Homing;
use fivebar_sim::live::{LiveArm, LiveError, Pending};
use futures_util::StreamExt;
use ros2_client::qos::History;
use ros2_client::{Name, Node, QosProfile, ServiceMapping, ServiceTypeName};
use std::rc::Rc;
use std::sync::Arc;
use tokio::task::{spawn_blocking, spawn_local};

/// What a service does.
type Work = fn(&LiveArm) -> Result<(), LiveError>;

fn finish(begun: Result<Pending, LiveError>) -> Result<(), LiveError> {
    begun?.finish()
}

/// Each service by its name behind the node's.
const SERVICES: [(&str, Work); 6] = [
    ("home", |arm| finish(arm.home(Homing::IfUnknown))),
    ("motors_on", |arm| finish(arm.motors_on())),
    ("motors_off", |arm| finish(arm.motors_off())),
    ("stop", |arm| {
        arm.stop();
        Ok(())
    }),
    ("emergency_stop", LiveArm::emergency_stop),
    ("clear_fault", |arm| finish(arm.clear_fault())),
];

/// Begins to serve.
pub(super) fn begin(node: &mut Node, arm: &Arc<LiveArm>, name: &str) -> Result<(), RosError> {
    for (service, work) in SERVICES {
        serve(node, arm.clone(), &format!("/{name}"), service, work)?;
    }
    Ok(())
}

fn serve(
    node: &mut Node,
    arm: Arc<LiveArm>,
    node_name: &str,
    service: &str,
    work: Work,
) -> Result<(), RosError> {
    let qos = QosProfile::publisher_default().history(History::KeepLast { depth: 10 });
    let server = node.create_server::<TriggerRequest, TriggerResponse>(
        ServiceMapping::Enhanced,
        &Name::new(node_name, service)?,
        &ServiceTypeName::new("std_srvs", "Trigger"),
        qos.clone(),
        qos,
    )?;
    let server = Rc::new(server);
    spawn_local(async move {
        let mut requests = std::pin::pin!(server.receive_request_stream());
        while let Some(request) = requests.next().await {
            let Ok((id, _)) = request else {
                continue;
            };
            let (server, arm) = (server.clone(), arm.clone());
            spawn_local(async move {
                let done = spawn_blocking(move || work(&arm)).await;
                let message = match done {
                    Ok(Ok(())) => String::new(),
                    Ok(Err(error)) => error.to_string(),
                    Err(error) => error.to_string(),
                };
                let success = message.is_empty();
                let answer = TriggerResponse { success, message };
                // A client that is gone gets none.
                let _ = server.async_send_response(id, answer).await;
            });
        }
    });
    Ok(())
}
