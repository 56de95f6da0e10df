// A client of node-opcua: it reads, writes, subscribes, gets an event and calls; each answer is a line of JSON.
const {
  OPCUAClient, AttributeIds, ClientMonitoredItem, ClientSubscription, DataType, MessageSecurityMode, SecurityPolicy,
  TimestampsToReturn, constructEventFilter,
} = require("node-opcua-client");
const [url, http, secured] = process.argv.slice(2);
const CHANNEL = "ns=1;s=machine/CncChannelList/Channel1", SERVER = "ns=0;i=2253";
const say = (name, value) => console.log(JSON.stringify([name, value]));
const security = secured === "yes"
  ? { securityMode: MessageSecurityMode.SignAndEncrypt, securityPolicy: SecurityPolicy.Basic256Sha256 } : {};
const order = (command) => fetch(`${http}/api/machines/machine/commands`, { method: "POST", body: JSON.stringify(command) });

async function main() {
  const client = OPCUAClient.create({ endpointMustExist: false, connectionStrategy: { maxRetry: 1 }, ...security });
  await client.connect(url);
  const session = await client.createSession();
  const read = async (nodeId) => (await session.read({ nodeId, attributeId: AttributeIds.Value }));
  const write = async (nodeId, dataType, value) =>
    (await session.write({ nodeId, attributeId: AttributeIds.Value, value: { value: { dataType, value } } })).name;
  const below = await session.browse("ns=1;s=machine");
  say("below", below.references.map((each) => each.browseName.name));
  const position = (await read("ns=1;s=machine/CncAxisList/Y/PosDirect")).value.value;
  say("position", [position.actPos, position.cmdPos, position.remDist]);
  say("unit", (await read(`${CHANNEL}/CmdOverride/EngineeringUnits`)).value.value.unitId);
  say("unknown", (await read("ns=1;s=machine/CncAxisList/Y/ActPower")).statusCode.name);

  const subscription = ClientSubscription.create(session, { requestedPublishingInterval: 50, requestedLifetimeCount: 1000,
    requestedMaxKeepAliveCount: 20, publishingEnabled: true });
  const item = ClientMonitoredItem.create(subscription, { nodeId: `${CHANNEL}/ActOverride`, attributeId: AttributeIds.Value },
    { samplingInterval: 50, queueSize: 10 }, TimestampsToReturn.Both);
  const changed = new Promise((resolve) => item.on("changed", ({ value }) => { if (value.value === 63) resolve(value.value); }));
  const fields = ["Message", "Severity", "ActiveState.Id"];
  const alarms = ClientMonitoredItem.create(subscription, { nodeId: SERVER, attributeId: AttributeIds.EventNotifier },
    { samplingInterval: 0, queueSize: 100, filter: constructEventFilter(fields) }, TimestampsToReturn.Both);
  const event = new Promise((resolve) => alarms.on("changed", (values) => resolve(values.map((each) => each.value?.text ?? each.value))));
  await Promise.all([item, alarms].map((each) => new Promise((resolve) => each.on("initialized", resolve))));
  say("write", await write(`${CHANNEL}/CmdOverride`, DataType.Double, 63));
  say("too much", await write(`${CHANNEL}/CmdOverride`, DataType.Double, 630));
  say("other type", await write(`${CHANNEL}/CmdOverride`, DataType.Int32, 63));
  say("fixed", await write(`${CHANNEL}/ActOverride`, DataType.Double, 63));
  say("changed", await changed);
  await order({ command: "emergency_stop", on: true });
  say("event", await event);
  const call = { objectId: "ns=0;i=2782", methodId: "ns=0;i=3875",
    inputArguments: [{ dataType: DataType.UInt32, value: subscription.subscriptionId }] };
  say("refresh", (await session.call(call)).statusCode.name);
  say("history", (await session.readHistoryValue(`${CHANNEL}/Id`, new Date(0), new Date())).statusCode.name);
  await order({ command: "emergency_stop", on: false });
  await subscription.terminate();
  await session.close();
  await client.disconnect();
}
main().catch((error) => { console.error(error); process.exit(1); });
